"""A model of visual attention: saliency maps and ordered fixations on views of objects.

It takes arrays of pixels, points and normals and gives arrays; it handles no meshes, cameras or
touch, and uses nothing of the rest of the project.
"""

from .channels import WorkingView, prepare_view
from .errors import AttentionError
from .model import Attention, attend, reasons_to_skip
from .parameters import AttentionParameters, ChannelWeights
from .registry import CHANNELS, TERMS
from .saliency import conspicuity_maps, saliency_map
from .scanpath import Scanpath, scan

__all__ = [
    "CHANNELS",
    "TERMS",
    "Attention",
    "AttentionError",
    "AttentionParameters",
    "ChannelWeights",
    "Scanpath",
    "WorkingView",
    "attend",
    "conspicuity_maps",
    "prepare_view",
    "reasons_to_skip",
    "saliency_map",
    "scan",
]
