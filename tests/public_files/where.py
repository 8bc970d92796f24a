"""Readers of users' files by lasting names: checks from outside the repository call them here, wherever they move."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import SimpleNamespace

from human_gaze.recordings import GazeError, find_recordings, read_recording
from visuohaptic.base.errors import MeshError, ParameterError, RecognitionError
from visuohaptic.meshes.model_files import read_mesh
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.own import read_study
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table

__all__ = [
    "FEATURES",
    "ExperimentParameters",
    "GazeError",
    "MeshError",
    "ParameterError",
    "RecognitionError",
    "build_table",
    "find_recordings",
    "read_model",
    "read_recording",
    "read_study",
    "read_tactile_images",
]

EXAMPLE = Path(__file__).parents[2] / "packages/contourlets/examples/tactile_images.py"

read_model = read_mesh


def read_tactile_images(folder):
    """Read pictures by the example of contourlets, which refuses them by an error of Python's own."""
    spec = importlib.util.spec_from_file_location("tactile_images", EXAMPLE)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    try:
        images, classes = example.read_tactile_images(folder)
    except ValueError as error:
        raise RecognitionError(str(error)) from error
    return SimpleNamespace(images=images, classes=classes)
