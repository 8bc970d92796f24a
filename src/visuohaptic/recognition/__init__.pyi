from .experiment import run_pipeline as run_pipeline
from .parameters import RecognitionParameters as RecognitionParameters
from .summary import Confusion as Confusion
from .summary import confusion as confusion
from .summary import select as select
from .summary import summarise as summarise

__all__ = [
    "Confusion",
    "RecognitionParameters",
    "confusion",
    "run_pipeline",
    "select",
    "summarise",
]
