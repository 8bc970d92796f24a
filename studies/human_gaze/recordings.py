"""Recordings of gaze: files that say how long people looked at each point of a mesh.

Text has a point a line: x y z seconds, x y z and a normal and seconds, or the same with a last column that
is not used; or one number, a line for each vertex of the mesh. An npz file has `seconds`, and may have
`points` and `normals`.
"""

from __future__ import annotations

import hashlib
import io
import warnings
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import VisuohapticError
from visuohaptic.meshes.catalogue import MODEL_SUFFIXES

GAZE_SUFFIXES = (".txt", ".npz")
"""How files of recorded gaze end."""

MOST_POINTS = 1_000_000
MOST_FILES = 10_000
# What the columns of a text file hold, by their number.
_PLACE, _NORMAL = slice(3), slice(3, 6)
_COLUMNS: dict[int, dict[str, int | slice]] = {
    1: {"seconds": 0},
    4: {"points": _PLACE, "seconds": 3},
    7: {"points": _PLACE, "normals": _NORMAL, "seconds": 6},
    8: {"points": _PLACE, "normals": _NORMAL, "seconds": 6},
}


class GazeError(VisuohapticError):
    """A recording of gaze can't be used, or does not belong to its mesh."""


@dataclass(frozen=True)
class RecordingFile:
    """A recording, not yet read, and the model file of its name; weights are never fitted on tests."""

    name: str
    gaze: Path
    mesh: Path | None
    is_test: bool


@dataclass(frozen=True)
class Recording:
    """How long people looked at each point of an object.

    `points` (n, 3) are in the file's own frame and unit, None where each number belongs to a vertex;
    `normals` (n, 3) are unit, or None; `seconds` (n,) at least 0; `digest` is the SHA-256 of the file.
    """

    name: str
    points: FloatArray | None
    normals: FloatArray | None
    seconds: FloatArray
    digest: str


def find_recordings(folder: str | Path) -> list[RecordingFile]:
    """List the recordings in a folder and below, by name.

    A recording is a test where a folder between has ``test`` in its name. Raises `GazeError` if there is no
    such folder, more than 10,000 files of gaze and meshes in it, no recording, or two of one name.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise GazeError(f"{folder} is no folder; one with recordings of gaze is needed.")
    endings = (*GAZE_SUFFIXES, *MODEL_SUFFIXES)
    paths = (path for path in folder.rglob("*") if path.suffix.lower() in endings)
    files = sorted(islice(filter(Path.is_file, paths), MOST_FILES + 1))
    if len(files) > MOST_FILES:
        raise GazeError(
            f"{folder} has more than {MOST_FILES:,} files of gaze and meshes, which is the most."
        )
    meshes = {path.stem: path for path in files if path.suffix.lower() in MODEL_SUFFIXES}
    found: dict[str, RecordingFile] = {}
    for path in files:
        if path.suffix.lower() not in GAZE_SUFFIXES or path.stem.lower() == "readme":
            continue
        if path.stem in found:
            raise GazeError(
                f"{found[path.stem].gaze} and {path} are recordings of one name; one is allowed, "
                "for an object must not be in two parts."
            )
        parts = path.relative_to(folder).parts[:-1]
        is_test = any("test" in part.lower() for part in parts)
        found[path.stem] = RecordingFile(path.stem, path, meshes.get(path.stem), is_test)
    if not found:
        raise GazeError(
            f"{folder} has no recording of gaze; files ending in {' or '.join(GAZE_SUFFIXES)} are."
        )
    return [found[name] for name in sorted(found)]


def read_recording(path: str | Path, largest_megabytes: float = 64.0) -> Recording:
    """Read one recording; `GazeError`, which names the file and the reason, if it is none or too large."""
    path = Path(path)
    data = read_bounded(path, largest_megabytes)
    read = _read_archive if path.suffix.lower() == ".npz" else _read_text
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # of an empty file NumPy only warns
            arrays = read(data, largest_megabytes)
        _check(arrays)
    # A damaged archive may fail in any way.
    except Exception as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__).rstrip(".")
        raise GazeError(f"{path} holds no recording of gaze: {reason}.") from error
    normals = arrays.get("normals")
    if normals is not None:
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    digest = hashlib.sha256(data).hexdigest()
    return Recording(path.stem, arrays.get("points"), normals, arrays["seconds"], digest)


def read_bounded(path: Path, largest_megabytes: float) -> bytes:
    """Read a file whole; `GazeError` if it can't be read or is larger than so many 10⁶ bytes."""
    largest = int(largest_megabytes * 10**6)
    try:
        with path.open("rb") as stream:
            data = stream.read(largest + 1)
    except OSError as error:
        raise GazeError(f"{path} can't be read: {error.strerror}.") from error
    if len(data) > largest:
        raise GazeError(f"{path} is larger than {largest_megabytes:g} MB, which is the most.")
    return data


_Arrays = dict[str, FloatArray]


def _read_text(data: bytes, _: float) -> _Arrays:
    lines = io.StringIO(data.decode("ascii").replace(",", " "))
    table = np.loadtxt(lines, ndmin=2, max_rows=MOST_POINTS + 1)
    if table.shape[1] not in _COLUMNS:
        allowed = ", ".join(map(str, _COLUMNS))
        raise ValueError(f"{table.shape[1]} columns; {allowed} are allowed")
    return {name: table[:, place] for name, place in _COLUMNS[table.shape[1]].items()}


def _read_archive(data: bytes, largest_megabytes: float) -> _Arrays:
    with ZipFile(io.BytesIO(data)) as packed:
        if sum(info.file_size for info in packed.infolist()) > largest_megabytes * 10**6:
            raise ValueError(f"it unpacks to more than {largest_megabytes:g} MB")
    with np.load(io.BytesIO(data), allow_pickle=False) as archive:
        known = [name for name in ("points", "normals", "seconds") if name in archive]
        found = {name: archive[name] for name in known}
    for name, values in found.items():
        if not isinstance(values, np.ndarray):
            raise TypeError(f"{name} is no array")
    return {name: values.astype(np.float64) for name, values in found.items()}


def _check(arrays: _Arrays) -> None:
    if "seconds" not in arrays:
        raise ValueError("no array `seconds`; one is needed")
    seconds = arrays["seconds"]
    if seconds.ndim != 1 or not 0 < len(seconds) <= MOST_POINTS:
        raise ValueError(f"seconds of shape {seconds.shape}; at most ({MOST_POINTS},) is allowed")
    for name, array in arrays.items():
        shape = seconds.shape if name == "seconds" else (len(seconds), 3)
        if array.shape != shape or not np.isfinite(array).all():
            raise ValueError(f"{name} of shape {array.shape}; {shape}, all finite, is allowed")
    if (seconds < 0).any() or not seconds.any():
        raise ValueError(
            "times below 0, or none above; at least one point must have been looked at"
        )
