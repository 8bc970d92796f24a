"""Classify objects from sequences of touches: pipelines, protocols, scores and their intervals."""

from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.model import RecognitionModel, fit_model
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.stored_models import load_model, save_model

__all__ = [
    "RecognitionModel",
    "RecognitionParameters",
    "fit_model",
    "load_model",
    "run_pipeline",
    "save_model",
]
