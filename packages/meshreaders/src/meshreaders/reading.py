"""Read a mesh from a path, an open file or an object in memory."""

from __future__ import annotations

import codecs
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Literal, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from meshreaders.base.errors import MeshError, TooLargeError
from meshreaders.base.mesh import Mesh
from meshreaders.base.regular_files import open_regular, read_bounded
from meshreaders.base.suffixes import MODEL_SUFFIXES, why_unreadable
from meshreaders.companions import Companions, FolderCompanions
from meshreaders.content import BEGINNING, other_content
from meshreaders.formats.collada import read_collada
from meshreaders.formats.gltf_files import read_gltf
from meshreaders.formats.obj_files import read_obj
from meshreaders.formats.off_files import read_off
from meshreaders.formats.ply_files import read_ply
from meshreaders.formats.stl_files import read_stl
from meshreaders.formats.three_mf import read_3mf
from meshreaders.in_memory import parts_in_memory
from meshreaders.parts import Part, join_parts

if TYPE_CHECKING:
    from trimesh import Scene, Trimesh

Source: TypeAlias = "str | Path | BinaryIO | Trimesh | Scene | Mesh | tuple[ArrayLike, ArrayLike]"
"""Types of sources of a mesh; also a `TriangleMesh` of Open3D, legacy or tensor, and a `PolyData` of PyVista."""

UNNAMED = "object"
"""Name in messages of a mesh that has no file name."""

# Formats with a text form, which may begin with a byte order mark.
_TEXT_KINDS = ("obj", "off", "ply", "gltf", "dae", "stl")
_MOST_MISSING = 5  # missing files that a note lists
_MOST_NOTES = 5

_Axis: TypeAlias = Literal["x", "y", "z"] | None
_Result = TypeVar("_Result")


@dataclass(frozen=True, eq=False)
class Parts:
    """The parts of a model that are read one by one, before they are joined.

    Attributes
    ----------
    parts : tuple of Part
        Triangles with one image or no image each, in the order of the file. A part may have vertices without a face.
    notes : tuple of str
        As of `Mesh`.
    up_axis : {"x", "y", "z"}, optional
        As of `Mesh`.
    """

    parts: tuple[Part, ...]
    notes: tuple[str, ...]
    up_axis: _Axis


def read(source: Source, file_type: str | None = None, largest_megabytes: float = 512.0) -> Mesh:
    """Read a mesh from any source, and join all its parts to one mesh with colours and images.

    Parameters
    ----------
    source : path, binary file, trimesh.Trimesh or Scene, open3d TriangleMesh, pyvista.PolyData, (vertices, faces) or Mesh
        The mesh. A `Mesh` is returned unchanged.
    file_type : str, optional
        Format of an open file, such as ``obj``; by default the suffix of its name. Ignored for other sources.
    largest_megabytes : float
        Largest size of a file, in 10⁶ bytes.

    Returns
    -------
    Mesh
        Triangles in the frame and unit of the source, glTF in metres. Unused vertices are dropped, except those of a
        `Mesh`. Files that a model refers to, such as images, are read only from the folder of the path and below.
        An open file has no folder, so these files are missing. `Mesh.notes` has up to five sentences; the first
        names up to five missing files. NaN or infinite vertices are counted in a sentence before these.

    Raises
    ------
    MeshError
        If the source has another type, can't be read, or has no triangle; also if a buffer of a glTF file is missing.
    """
    if isinstance(source, Mesh):
        return source
    mesh, notes, up_axis = _read(source, file_type, largest_megabytes, join_parts)
    notes = (*notes_on_vertices(mesh, name_of(source)), *notes)
    return replace(mesh, notes=notes, up_axis=up_axis)


def read_parts(
    source: Source, file_type: str | None = None, largest_megabytes: float = 512.0
) -> Parts:
    """Read the parts of a mesh one by one, such as primitives of glTF, each at its places in the scene.

    Arguments and errors are those of `read`. No part needs a face, and a `Mesh`, which has no parts, is refused.
    """
    return Parts(*_read(source, file_type, largest_megabytes, tuple))


def notes_on_vertices(mesh: Mesh, name: str) -> tuple[str, ...]:
    """Return a sentence that counts the NaN and infinite vertices of a mesh; empty without such vertices."""
    broken = int((~np.isfinite(mesh.vertices)).any(axis=1).sum())
    return (f"{name} has {broken} NaN or infinite vertices.",) if broken else ()


def name_of(source: Source) -> str:
    """Return the name of a mesh for messages.

    The name is the path as given; the file name of an open file without folder and suffix; or ``object``.
    """
    if isinstance(source, str | Path):
        return str(source)
    file_name = getattr(source, "name", None)
    stem = Path(file_name).stem if isinstance(file_name, str) else ""
    # Names of files may have undecodable bytes, which a table can't store.
    return stem.encode("utf-8", "replace").decode("utf-8") or UNNAMED


def read_data(data: bytes, kind: str, name: str, companions: Companions) -> Mesh:
    """Read the content of a model file as a mesh.

    `kind` is a suffix of `MODEL_SUFFIXES` without the dot, in upper or lower case; another kind raises `KeyError`.
    `companions` reads the files that the model refers to. Raises `MeshError` with `name` and the reason if the content is broken.
    """
    mesh, notes, up_axis = _read_content(data, kind, name, companions, join_parts)
    return replace(mesh, notes=notes, up_axis=up_axis)


def _read(
    source: Any,
    file_type: str | None,
    largest_megabytes: float,
    finish: Callable[[Sequence[Part]], _Result],
) -> tuple[_Result, tuple[str, ...], _Axis]:
    """Return the result of `finish` for the parts of a source, with notes and the up axis."""
    name = name_of(source)
    # Contents are passed on without a variable here, so that `_read_content` has the only reference.
    if isinstance(source, str | Path):
        path = Path(source)
        companions = FolderCompanions(path)
        return _read_content(
            _content_of(path, name, largest_megabytes), path.suffix[1:], name, companions, finish
        )
    if hasattr(source, "read"):
        kind = _kind_of(source, file_type)
        return _read_content(
            _read_bounded(source, name, largest_megabytes), kind, name, Companions(), finish
        )
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            return finish(parts_in_memory(source)), (), None
    except Exception as error:
        raise MeshError(f"{name} can't be read as a mesh: {_reason_of(error)}.") from error


def _read_content(
    data: bytes,
    kind: str,
    name: str,
    companions: Companions,
    finish: Callable[[Sequence[Part]], _Result],
) -> tuple[_Result, tuple[str, ...], _Axis]:
    """Return the result of `finish` for the parts in the content of a file, with notes and the up axis."""
    kind = kind.lower()
    read_parts_of = _READERS[kind]
    if kind in _TEXT_KINDS:
        data = data.removeprefix(codecs.BOM_UTF8)
    beginning = data[:BEGINNING]
    # Readers free the content before the mesh is built; a variable here would keep the content alive.
    only_reference = [data]
    del data
    # A parser may raise any error for a broken file.
    try:
        # Vertices that overflow are refused where the mesh is used, in a sentence that names the first.
        with np.errstate(over="ignore", invalid="ignore"):
            finished = finish(read_parts_of(only_reference.pop(), companions))
    except Exception as error:
        reason = other_content(beginning, kind) or _reason_of(error)
        raise MeshError(f"{name} can't be read as {kind.upper()}: {reason}.") from error
    return finished, _notes(name, companions), companions.up_axis


def _notes(name: str, companions: Companions) -> tuple[str, ...]:
    """Return up to `_MOST_NOTES` sentences; the first lists up to `_MOST_MISSING` missing files."""
    notes = [f"{name} {note}." for note in dict.fromkeys(companions.notes)]
    missing = list(dict.fromkeys(companions.missing))
    if missing:
        omitted = len(missing) - _MOST_MISSING
        listed = "; ".join(missing[:_MOST_MISSING]) + (
            f"; and {omitted} more" if omitted > 0 else ""
        )
        notes.insert(0, f"{name} refers to {listed}. Its faces are coloured without them.")
    return tuple(notes[:_MOST_NOTES])


def _reason_of(error: Exception) -> str:
    """Return the message of an error on one line, without full stop."""
    return " ".join(str(error).split())[:300].rstrip(".!") or "it is broken or truncated"


def _content_of(path: Path, name: str, largest_megabytes: float) -> bytes:
    if reason := why_unreadable(path.suffix):
        raise MeshError(f"{name} {reason}")
    try:
        with open_regular(path) as stream:
            return _read_bounded(stream, name, largest_megabytes)
    except OSError as error:
        raise MeshError(f"{name} can't be read: {error.strerror}.") from error


def _kind_of(stream: Any, file_type: str | None) -> str:
    """Return the format of an open file, a suffix in lower case without dot; raise `MeshError` if unsupported."""
    file_name = getattr(stream, "name", None)
    suffix = Path(file_name).suffix if isinstance(file_name, str) else ""
    kind = (suffix if file_type is None else file_type).lower().removeprefix(".")
    allowed = ", ".join(suffix.removeprefix(".") for suffix in MODEL_SUFFIXES)
    if not kind:
        raise MeshError(
            f"The open file has no name, so file_type is needed; {allowed} are allowed."
        )
    if f".{kind}" not in MODEL_SUFFIXES:
        raise MeshError(f"The open file's file_type is {kind!r}; {allowed} are allowed.")
    if reason := why_unreadable(f".{kind}"):
        raise MeshError(f"The open file {reason}")
    return kind


def _read_bounded(stream: BinaryIO, name: str, largest_megabytes: float) -> bytes:
    largest_bytes = int(largest_megabytes * 1e6)
    try:
        data = read_bounded(stream, largest_bytes)
    except TypeError as error:
        raise MeshError(f'{name} is open as text; open it with mode "rb".') from error
    if not data:
        raise MeshError(f"{name} is empty.")
    if len(data) > largest_bytes:
        raise TooLargeError(
            f"{name} is too large; {largest_megabytes:g} MB are allowed (largest_megabytes)."
        )
    return data


_READERS: dict[str, Callable[[bytes, Companions], Sequence[Part]]] = {
    "obj": read_obj,
    "ply": read_ply,
    "stl": read_stl,
    "off": read_off,
    "glb": read_gltf,
    "gltf": read_gltf,
    "3mf": read_3mf,
    "dae": read_collada,
}
