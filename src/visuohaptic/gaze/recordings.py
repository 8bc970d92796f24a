"""Recordings of gaze: files that say how long people looked at each point of a mesh.

A recording is read from a text file of numbers, a point a line, as x y z seconds, x y z and a normal and
seconds, or the same with a last column that is not used; from one number a line, a line for each vertex of
the mesh; or from an npz file with `points` and `seconds` (and `normals`), or `seconds` alone.
"""

from __future__ import annotations

import hashlib
import io
import warnings
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile, ZipFile

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import GazeError
from visuohaptic.gaze.parameters import GAZE_SUFFIXES
from visuohaptic.meshes.catalogue import MODEL_SUFFIXES

MOST_POINTS = 1_000_000
MOST_FILES = 10_000
# Columns of a text file: where the seconds stand, and where the normals start.
_COLUMNS = {1: (0, None), 4: (3, None), 7: (6, 3), 8: (6, 3)}


@dataclass(frozen=True)
class RecordingFile:
    """A recording of one object, not yet read; `mesh` is a model file of the same name.

    `is_test` says whether it lies in a folder for tests, which weights are never fitted on.
    """

    name: str
    gaze: Path
    mesh: Path | None
    is_test: bool


@dataclass(frozen=True)
class Recording:
    """How long people looked at each point of an object.

    `points` (n, 3) are in the file's own frame and unit; None where each number belongs to a vertex
    of the mesh. `normals` (n, 3) are of length 1; None where the file has none. `seconds` (n,) are
    at least 0; `digest` is the SHA-256 of the file.
    """

    name: str
    points: NDArray[np.float64] | None
    normals: NDArray[np.float64] | None
    seconds: NDArray[np.float64]
    digest: str


def find_recordings(folder: str | Path) -> list[RecordingFile]:
    """List the recordings in a folder and below, by name.

    A mesh belongs to the recording of its name. A recording counts as a test where a folder between
    it and `folder` has ``test`` in its name. Raises `GazeError` if there is no such folder, no
    recording in it, too many files, or two of one name.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise GazeError(f"gaze.folder is {folder}, which is no folder.")
    files = []
    for path in folder.rglob("*"):
        if path.suffix.lower() in (*GAZE_SUFFIXES, *MODEL_SUFFIXES) and path.is_file():
            files.append(path)
        if len(files) > MOST_FILES:
            raise GazeError(f"{folder} has more than {MOST_FILES} files; choose a smaller folder.")
    meshes = {path.stem: path for path in sorted(files) if path.suffix.lower() in MODEL_SUFFIXES}
    found: dict[str, RecordingFile] = {}
    for path in sorted(files):
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
    """Read one recording.

    Raises `GazeError` if the file can't be read, is too large, has other columns than the module
    says, or a number is not finite or a time below 0, or nobody looked at any point.
    """
    path = Path(path)
    data = read_bounded(path, largest_megabytes)
    read = _read_archive if path.suffix.lower() == ".npz" else _read_text
    points, normals, seconds = read(data, path, largest_megabytes)
    if not np.isfinite(seconds).all() or (seconds < 0).any():
        raise GazeError(f"{path} has times that are negative or not finite; 0 is the least.")
    if not seconds.sum() > 0:
        raise GazeError(f"{path} has no time above 0; at least one point must have been looked at.")
    for name, array in (("points", points), ("normals", normals)):
        if array is not None and not np.isfinite(array).all():
            raise GazeError(f"{path} has {name} that are not finite; none is allowed.")
    if normals is not None:
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    return Recording(path.stem, points, normals, seconds, hashlib.sha256(data).hexdigest())


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


_Arrays = tuple[NDArray[np.float64] | None, NDArray[np.float64] | None, NDArray[np.float64]]


def _read_text(data: bytes, path: Path, _: float) -> _Arrays:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # an empty file is only warned of
            table = np.loadtxt(
                io.StringIO(data.decode("ascii").replace(",", " ")),
                ndmin=2,
                max_rows=MOST_POINTS + 1,
            )
    except (ValueError, UserWarning) as error:
        raise GazeError(f"{path} is no table of numbers: {_first_line(error)}.") from error
    if len(table) > MOST_POINTS:
        raise GazeError(f"{path} has more than {MOST_POINTS:,} points, which is the most.")
    if table.shape[1] not in _COLUMNS:
        raise GazeError(
            f"{path} has {table.shape[1]} columns; {', '.join(map(str, _COLUMNS))} are allowed."
        )
    seconds, first_normal = _COLUMNS[table.shape[1]]
    points = table[:, :3] if seconds >= 3 else None
    normals = None if first_normal is None else table[:, first_normal : first_normal + 3]
    return points, normals, table[:, seconds]


def _read_archive(data: bytes, path: Path, largest_megabytes: float) -> _Arrays:
    try:
        with ZipFile(io.BytesIO(data)) as packed:
            unpacked = sum(info.file_size for info in packed.infolist())
            if unpacked > largest_megabytes * 10**6:
                raise GazeError(f"{path} unpacks to more than {largest_megabytes:g} MB.")
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = {
                name: np.asarray(archive[name], dtype=np.float64)
                for name in ("points", "normals", "seconds")
                if name in archive
            }
    except (ValueError, TypeError, OSError, EOFError, BadZipFile) as error:
        raise GazeError(f"{path} is no archive of numbers: {_first_line(error)}.") from error
    if "seconds" not in arrays:
        raise GazeError(f"{path} has no array `seconds`; one is needed.")
    seconds = arrays["seconds"]
    if seconds.ndim != 1 or not 0 < len(seconds) <= MOST_POINTS:
        raise GazeError(f"{path} has seconds of shape {seconds.shape}; (n,) is allowed.")
    for name in ("points", "normals"):
        if name in arrays and arrays[name].shape != (len(seconds), 3):
            raise GazeError(
                f"{path} has {name} of shape {arrays[name].shape}; {(len(seconds), 3)} is allowed."
            )
    return arrays.get("points"), arrays.get("normals"), seconds


def _first_line(error: BaseException) -> str:
    return str(error).splitlines()[0].rstrip(".") if str(error) else type(error).__name__
