"""Read recordings of gaze: files of how long people looked at each point of a mesh.

A text has one line per point: x y z seconds, or x y z, a normal and seconds, also with a last column that is not used. A
text may also have only one number per line, the seconds of each vertex of the mesh. Below a header, columns x, y, z, nx,
ny, nz and seconds are read by name. An npz file has `seconds`, and may have `points` and `normals`.
"""

from __future__ import annotations

import hashlib
import io
import math
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from meshreaders import MODEL_SUFFIXES
from meshreaders.base.regular_files import open_regular
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import TableError, VisuohapticError
from visuohaptic.io.text_tables import TextTable, read_text_table

GAZE_SUFFIXES = (".txt", ".npz")
"""Endings of files of recorded gaze."""

MOST_POINTS = 1_000_000
MOST_FILES = 10_000
_PLACE, _NORMAL, _SECONDS = ("x", "y", "z"), ("nx", "ny", "nz"), ("seconds",)
# Columns of a text without a header, by number of columns.
_COLUMNS = {
    1: _SECONDS,
    4: (*_PLACE, *_SECONDS),
    7: (*_PLACE, *_NORMAL, *_SECONDS),
    8: (*_PLACE, *_NORMAL, *_SECONDS, "not used"),
}


class GazeError(VisuohapticError):
    """A recording of gaze can't be used, or does not belong to its mesh."""


@dataclass(frozen=True)
class RecordingFile:
    """A recording that is not read yet, and the mesh of the same name, if any; weights are never fitted on tests."""

    name: str
    gaze: Path
    mesh: Path | None
    is_test: bool


@dataclass(frozen=True)
class Recording:
    """How long people looked at each point of an object.

    Attributes
    ----------
    name : str
        Name of the object.
    points : ndarray of shape (n, 3) or None
        Points in the frame and unit of the file; None if `seconds` are those of the vertices of the mesh.
    normals : ndarray of shape (n, 3) or None
        Unit normals.
    seconds : ndarray of shape (n,)
        Time at each point, at least 0.
    digest : str
        SHA-256 of the file.
    """

    name: str
    points: FloatArray | None
    normals: FloatArray | None
    seconds: FloatArray
    digest: str


def find_recordings(folder: str | Path) -> list[RecordingFile]:
    """Return the recordings in a folder and its subfolders, sorted by name.

    A recording is a test if a subfolder on its path has ``test`` in its name. Raises `GazeError` if there is no such
    folder or no recording, for more than `MOST_FILES` files, and for two recordings or two meshes of one name.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise GazeError(f"{folder} is no folder; a folder with recordings of gaze is needed.")
    endings = (*GAZE_SUFFIXES, *MODEL_SUFFIXES)
    paths = (path for path in folder.rglob("*") if path.suffix.lower() in endings)
    files = sorted(islice(filter(Path.is_file, paths), MOST_FILES + 1))
    if len(files) > MOST_FILES:
        raise GazeError(
            f"{folder} has more than {MOST_FILES:,} files of gaze and meshes; at most {MOST_FILES:,} are allowed."
        )
    meshes: dict[str, list[Path]] = {}
    for path in files:
        if path.suffix.lower() in MODEL_SUFFIXES:
            meshes.setdefault(path.stem, []).append(path)
    recordings: dict[str, RecordingFile] = {}
    for path in files:
        if path.suffix.lower() not in GAZE_SUFFIXES or path.stem.lower() == "readme":
            continue
        if path.stem in recordings:
            raise GazeError(
                f"{recordings[path.stem].gaze} and {path} are recordings of one name; one per object is allowed, "
                "because an object must not be in training and test."
            )
        same_name = meshes.get(path.stem, [])
        if len(same_name) > 1:
            raise GazeError(
                f"{path} has {len(same_name)} meshes of its name, {same_name[0]} and {same_name[1]}; one is allowed."
            )
        subfolders = path.relative_to(folder).parts[:-1]
        is_test = any("test" in subfolder.lower() for subfolder in subfolders)
        mesh = same_name[0] if same_name else None
        recordings[path.stem] = RecordingFile(path.stem, path, mesh, is_test)
    if not recordings:
        raise GazeError(
            f"{folder} has no recording of gaze; files ending in {' or '.join(GAZE_SUFFIXES)} are needed."
        )
    return [recordings[name] for name in sorted(recordings)]


def read_recording(path: str | Path, largest_megabytes: float = 64.0) -> Recording:
    """Read a recording from a text or npz file.

    Raises `GazeError`, which names file and reason, if the file is larger than `largest_megabytes` (10⁶ bytes), or is no
    recording.
    """
    path = Path(path)
    data = read_bounded(path, largest_megabytes)
    if path.suffix.lower() == ".npz":
        arrays = _read_archive(data, path, largest_megabytes)
    else:
        arrays = _read_text(data, path)
    normals = arrays.get("normals")
    if normals is not None:
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    digest = hashlib.sha256(data).hexdigest()
    return Recording(path.stem, arrays.get("points"), normals, arrays["seconds"], digest)


def read_bounded(path: Path, largest_megabytes: float) -> bytes:
    """Return the content of a file.

    Raises `GazeError` if the file can't be read or is larger than `largest_megabytes` (10⁶ bytes).
    """
    largest = int(largest_megabytes * 10**6)
    try:
        with open_regular(path) as stream:
            data = stream.read(largest + 1)
    except OSError as error:
        raise GazeError(f"{path} can't be read: {error.strerror}.") from error
    if len(data) > largest:
        raise GazeError(
            f"{path} is larger than {largest_megabytes:g} MB; at most so much is allowed."
        )
    return data


_Arrays = dict[str, FloatArray]


def _read_text(data: bytes, path: Path) -> _Arrays:
    try:
        table = read_text_table(data, str(path), MOST_POINTS, {*_PLACE})
        names = tuple(name.lower() for name in table.names) or _unnamed_columns(table)
        groups: dict[str, tuple[str, ...]] = {"seconds": _SECONDS}
        if names != _SECONDS:
            groups["points"] = _PLACE
        if set(_NORMAL) & {*names}:
            groups["normals"] = _NORMAL
        chosen = [name for group in groups.values() for name in group]
        for name in chosen:
            if names.count(name) != 1:
                raise GazeError(
                    f"{path} has {names.count(name)} columns {name} in its header; {', '.join(chosen)} are "
                    "needed, each once."
                )
        values = table.numbers([names.index(name) for name in chosen])
    except TableError as error:
        raise GazeError(str(error)) from error
    arrays = {
        kind: values[:, [chosen.index(name) for name in group]] for kind, group in groups.items()
    }
    arrays["seconds"] = arrays["seconds"][:, 0]
    _check_seconds(arrays["seconds"], path)
    return arrays


def _unnamed_columns(table: TextTable) -> tuple[str, ...]:
    width = len(table.columns)
    if width not in _COLUMNS:
        allowed = ", ".join(map(str, _COLUMNS))
        raise GazeError(
            f"{table.position(0)} has {width} columns; without a header {allowed} are allowed."
        )
    return _COLUMNS[width]


def _read_archive(data: bytes, path: Path, largest_megabytes: float) -> _Arrays:
    try:
        arrays = _read_arrays(data, int(largest_megabytes * 10**6))
        _check(arrays)
    # A damaged archive may raise any error.
    except Exception as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__).rstrip(".")
        raise GazeError(f"{path} holds no recording of gaze: {reason}.") from error
    _check_seconds(arrays["seconds"], path)
    return arrays


def _read_arrays(data: bytes, largest_bytes: int) -> _Arrays:
    arrays: _Arrays = {}
    bytes_left = largest_bytes
    with ZipFile(io.BytesIO(data)) as packed:
        members = {name.removesuffix(".npy"): name for name in packed.namelist()}
        for name in ("points", "normals", "seconds"):
            if name not in members:
                continue
            with packed.open(members[name]) as stream:
                # The size of a member in the archive's directory may be wrong.
                content = stream.read(bytes_left + 1)
            bytes_left -= len(content)
            if bytes_left < 0:
                raise ValueError(f"it unpacks to more than {largest_bytes / 1e6:g} MB")
            arrays[name] = _read_array(content, name)
    return arrays


def _read_array(content: bytes, name: str) -> FloatArray:
    if not content.startswith(np.lib.format.MAGIC_PREFIX):
        raise ValueError(f"{name} is no array")
    stream = io.BytesIO(content)
    major, _ = np.lib.format.read_magic(stream)
    is_first = major == 1  # the third version is for names of columns, which plain numbers lack
    read_header = (
        np.lib.format.read_array_header_1_0 if is_first else np.lib.format.read_array_header_2_0
    )
    shape, _, dtype = read_header(stream)
    if dtype.kind not in "iuf":
        raise ValueError(f"{name} holds {dtype} and no numbers")
    # NumPy allocates memory for the shape in the header, so the shape must fit the content.
    if math.prod(shape) * dtype.itemsize != len(content) - stream.tell():
        raise ValueError(f"{name} does not hold the {shape} numbers that its header claims")
    array = np.lib.format.read_array(io.BytesIO(content), allow_pickle=False)
    return np.asarray(array, dtype=np.float64)


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


def _check_seconds(seconds: FloatArray, path: Path) -> None:
    if (seconds < 0).any() or not seconds.any():
        raise GazeError(
            f"{path} has times below 0, or only zeros; times of at least 0, one of them above, are needed."
        )
