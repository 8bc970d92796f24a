from .channels import WorkingView as WorkingView
from .channels import prepare_view as prepare_view
from .errors import AttentionError as AttentionError
from .fitting import Example as Example
from .fitting import fit_weights as fit_weights
from .model import Attention as Attention
from .model import attend as attend
from .model import feature_planes as feature_planes
from .model import reasons_to_skip as reasons_to_skip
from .parameters import AttentionParameters as AttentionParameters
from .parameters import ChannelWeights as ChannelWeights
from .parameters import TermWeights as TermWeights
from .registry import CHANNELS as CHANNELS
from .registry import TERMS as TERMS
from .saliency import conspicuity_maps as conspicuity_maps
from .saliency import saliency_map as saliency_map
from .scanpath import Scanpath as Scanpath
from .scanpath import scan as scan
from .surface_measures import MEASURES as MEASURES
from .surface_measures import GazedSurface as GazedSurface

__all__ = [
    "CHANNELS",
    "MEASURES",
    "TERMS",
    "Attention",
    "AttentionError",
    "AttentionParameters",
    "ChannelWeights",
    "Example",
    "GazedSurface",
    "Scanpath",
    "TermWeights",
    "WorkingView",
    "attend",
    "conspicuity_maps",
    "feature_planes",
    "fit_weights",
    "prepare_view",
    "reasons_to_skip",
    "saliency_map",
    "scan",
]
