from .experiment import run_pipeline as run_pipeline
from .model import RecognitionModel as RecognitionModel
from .model import fit_model as fit_model
from .parameters import RecognitionParameters as RecognitionParameters
from .stored_models import load_model as load_model
from .stored_models import save_model as save_model
from .summary import Confusion as Confusion
from .summary import confusion as confusion
from .summary import select as select
from .summary import summarise as summarise
from .touch_classifier import TouchClassifier as TouchClassifier
from .touch_classifier import touch_descriptors as touch_descriptors

__all__ = [
    "Confusion",
    "RecognitionModel",
    "RecognitionParameters",
    "TouchClassifier",
    "confusion",
    "fit_model",
    "load_model",
    "run_pipeline",
    "save_model",
    "select",
    "summarise",
    "touch_descriptors",
]
