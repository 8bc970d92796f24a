"""Read predictions of others for recorded objects: text or npz in the form of recordings, or a PLY file of points.

A PLY file has the values as colours of the scale ``jet``, from which they are read to 1 in 255.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from plyfile import PlyData, PlyParseError
from scipy.spatial import cKDTree

from human_gaze.recordings import (
    GAZE_SUFFIXES,
    MOST_POINTS,
    GazeError,
    read_bounded,
    read_recording,
)
from meshreaders.base.ply_header import LONGEST, check_ply_size, read_ply_header
from visuohaptic.base.arrays import FloatArray

ENDINGS = ("", "_pred")
"""Endings of file names after the name of the object."""

# Matplotlib's `jet`: positions of the corners of red, green and blue, and the values there.
_JET = (
    ((0, 0.35, 0.66, 0.89, 1), (0, 0, 1, 1, 0.5)),
    ((0, 0.125, 0.375, 0.64, 0.91, 1), (0, 0, 1, 1, 0, 0)),
    ((0, 0.11, 0.34, 0.65, 1), (0.5, 1, 1, 0, 0)),
)
# Largest distance of a colour from the scale, levels of 255.
_FARTHEST = 3.0


def find_peer(folder: str | Path, name: str) -> Path | None:
    """Return the file with the prediction for an object; None if there is none.

    Raises `GazeError` if there is no such folder.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise GazeError(f"{folder} is no folder; a folder with a peer's predictions is needed.")
    files = (
        folder / f"{name}{end}{suffix}" for end in ENDINGS for suffix in (".ply", *GAZE_SUFFIXES)
    )
    return next((file for file in files if file.is_file()), None)


def read_peer(path: Path, largest_megabytes: float) -> tuple[FloatArray, FloatArray]:
    """Read a prediction: points (n, 3) in the frame of the file, and values (n,), at least 0.

    Raises `GazeError` if the file can't be read, is larger than `largest_megabytes` (10⁶ bytes), has no points, or has
    colours that are not of the scale ``jet``.
    """
    if path.suffix.lower() == ".ply":
        return _read_coloured(path, largest_megabytes)
    prediction = read_recording(path, largest_megabytes)
    if prediction.points is None:
        raise GazeError(f"{path} has values and no points; x y z and a value are needed.")
    return prediction.points, prediction.seconds


def _read_coloured(path: Path, largest_megabytes: float) -> tuple[FloatArray, FloatArray]:
    data = read_bounded(path, largest_megabytes)
    try:
        check_ply_size(read_ply_header(data[:LONGEST]), len(data))
        rows = PlyData.read(io.BytesIO(data))["vertex"].data[: MOST_POINTS + 1]
        points = np.column_stack([rows[name] for name in "xyz"]).astype(np.float64)
        colours = np.column_stack([rows[name] for name in ("red", "green", "blue")])
    except (PlyParseError, KeyError, ValueError) as error:
        raise GazeError(f"{path} holds no coloured points: {error}.") from error
    if not 0 < len(points) <= MOST_POINTS or not np.isfinite(points).all():
        raise GazeError(
            f"{path} has no points, more than {MOST_POINTS:,}, or points that are not finite."
        )
    scale = np.linspace(0, 1, 256)
    jet = np.column_stack([np.interp(scale, *corners) for corners in _JET]) * 255
    distance, index = cKDTree(jet).query(colours.astype(np.float64))
    if distance.max() > _FARTHEST:
        raise GazeError(
            f"{path} has colours that are not of the scale jet; only this scale can be read."
        )
    return points, scale[index]
