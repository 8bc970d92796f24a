"""Read a mesh from a path, an open file or an object in memory as a coloured surface."""

from __future__ import annotations

import codecs
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias
from zipfile import ZipFile

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.base.errors import MeshError
from visuohaptic.base.regular_files import open_regular, read_bounded
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.catalogue import MODEL_SUFFIXES, why_unreadable
from visuohaptic.meshes.collada import read_collada
from visuohaptic.meshes.companions import ArchiveCompanions, Companions, FolderCompanions
from visuohaptic.meshes.content import BEGINNING, other_content
from visuohaptic.meshes.gltf_files import read_gltf
from visuohaptic.meshes.in_memory import parts_in_memory
from visuohaptic.meshes.obj_files import read_obj
from visuohaptic.meshes.off_files import read_off
from visuohaptic.meshes.parts import Part, join_parts
from visuohaptic.meshes.ply_files import read_ply
from visuohaptic.meshes.stl_files import read_stl
from visuohaptic.meshes.three_mf import read_3mf

if TYPE_CHECKING:
    from trimesh import Scene, Trimesh

Source: TypeAlias = (
    "str | Path | BinaryIO | Trimesh | Scene | Surface | tuple[ArrayLike, ArrayLike]"
)
"""Types of sources of a mesh; also a `TriangleMesh` of Open3D, legacy or tensor."""

UNNAMED = "object"
"""Name in messages of a mesh that has no file name."""

PACKED = ".ply.gz"
"""Suffix of files that `write_surface` writes."""

# Formats with a text form, which may begin with a byte order mark.
_TEXT_KINDS = ("obj", "off", "ply", "gltf", "dae", "stl")
_MOST_MISSING = 5  # missing files that a note lists
_MOST_NOTES = 5


def read_mesh(
    source: Source, file_type: str | None = None, largest_megabytes: float = 512.0
) -> Surface:
    """Read a mesh from any source, and join all its parts to one surface with colours and images.

    Parameters
    ----------
    source : path, binary file, trimesh.Trimesh or Scene, open3d TriangleMesh, (vertices, faces) or Surface
        The mesh. A path may also name a packed surface, ``.ply.gz``. A `Surface` is returned unchanged.
    file_type : str, optional
        Format of an open file, such as ``obj``; by default the suffix of its name. Ignored for other sources.
    largest_megabytes : float
        Largest size of a file, in 10⁶ bytes; of a packed surface, the size after unpacking.

    Returns
    -------
    Surface
        Triangles in the frame and unit of the source, glTF in metres. Unused vertices are dropped, except those of a
        `Surface`. Files that a model refers to, such as images, are read only from the folder of the path and below.
        An open file has no folder, so these files are missing. `Surface.notes` has up to five sentences; if files are
        missing, the first names up to five of them.

    Raises
    ------
    MeshError
        If the source has another type, can't be read, or has no triangle; also if a buffer of a glTF file is missing.
    """
    if isinstance(source, Surface):
        return source
    name = name_of(source)
    if isinstance(source, str | Path):
        return _read_path(Path(source), name, largest_megabytes)
    if hasattr(source, "read"):
        stream: Any = source
        kind = _kind_of(stream, file_type)
        return read_data(_read_bounded(stream, name, largest_megabytes), kind, name, Companions())
    return _surface([source], _parts_in_memory, name, "a mesh", Companions())


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


def surface_from_archive(data: bytes, name: str, archive: ZipFile) -> Surface:
    """Read the content `data` of a member of a zip archive of the catalogue as a surface.

    `name` is the path of the member in the archive, with the suffix of a model file. Files that the member refers to
    are read from the same folder of the archive and below. Surfaces of the catalogue are pinned, so polygons are cut
    as they were for them: some lack corners.
    """
    companions = ArchiveCompanions(archive, name)
    companions.keep_corners = False
    return read_data(data, Path(name).suffix[1:], name, companions)


def read_data(data: bytes, kind: str, name: str, companions: Companions) -> Surface:
    """Read the content of a model file as a surface.

    `kind` is a suffix of `MODEL_SUFFIXES` without the dot, in upper or lower case; another kind raises `KeyError`.
    `companions` reads the files that the model refers to. Raises `MeshError` with `name` and the reason if the content is broken.
    """
    kind = kind.lower()
    if kind in _TEXT_KINDS:
        data = data.removeprefix(codecs.BOM_UTF8)
    holder = [data]
    del data
    return _surface(holder, _READERS[kind], name, kind.upper(), companions)


def _surface(
    holder: list[Any],
    read: Callable[[Any, Companions], Sequence[Part]],
    name: str,
    kind: str,
    companions: Companions,
) -> Surface:
    """Read the only item of `holder` as a surface; the item is removed from the list so that `read` can free it."""
    beginning = holder[0][:BEGINNING] if isinstance(holder[0], bytes) else b""
    # A parser may raise any error for a broken file.
    try:
        # Vertices that overflow are refused where the surface is used, in a sentence that names the first.
        with np.errstate(over="ignore", invalid="ignore"):
            # No variable here refers to the content, so that `read` can free it.
            surface = join_parts(read(holder.pop(), companions))
    except Exception as error:
        reason = other_content(beginning, kind.lower()) or _reason_of(error)
        raise MeshError(f"{name} can't be read as {kind}: {reason}.") from error
    return replace(surface, notes=_notes(name, companions), up_axis=companions.up_axis)


def _parts_in_memory(mesh: Any, companions: Companions) -> Sequence[Part]:  # noqa: ARG001
    return parts_in_memory(mesh)


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


def _read_path(path: Path, name: str, largest_megabytes: float) -> Surface:
    if name.endswith(PACKED):
        return read_surface(path, largest_megabytes)
    if reason := why_unreadable(path.suffix):
        raise MeshError(f"{name} {reason}")
    try:
        with open_regular(path) as stream:
            holder = [_read_bounded(stream, name, largest_megabytes)]
    except OSError as error:
        raise MeshError(f"{name} can't be read: {error.strerror}.") from error
    return read_data(holder.pop(), path.suffix[1:], name, FolderCompanions(path))


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
        raise MeshError(
            f"{name} is too large; {largest_megabytes:g} MB are allowed (meshes.largest_megabytes)."
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
