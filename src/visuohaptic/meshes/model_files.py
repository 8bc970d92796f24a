"""Model files as people have them (OBJ, PLY, STL, GLB, glTF, OFF, 3MF, DAE), read into a coloured surface."""

from __future__ import annotations

import codecs
import io
from pathlib import Path
from typing import Any, BinaryIO
from zipfile import ZipFile

from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.catalogue import why_unreadable
from visuohaptic.meshes.collada import checked_collada
from visuohaptic.meshes.companions import (
    ArchiveCompanions,
    Companions,
    FolderCompanions,
    as_resolver,
)
from visuohaptic.meshes.gltf_files import add_wraps, check_gltf, gltf_document
from visuohaptic.meshes.in_memory import reason_of, surface_of_trimesh
from visuohaptic.meshes.obj_files import read_obj
from visuohaptic.meshes.off_files import read_off
from visuohaptic.meshes.parts import join_parts
from visuohaptic.meshes.ply_files import checked_ply
from visuohaptic.meshes.stl_files import checked_stl
from visuohaptic.meshes.three_mf import read_3mf

_TEXT_KINDS = ("obj", "off", "ply", "gltf", "dae")
# What trimesh reads as it is meant once these have checked it.
_CHECKED = {"ply": checked_ply, "stl": checked_stl, "dae": checked_collada}


def read_model(path: str | Path, largest_megabytes: float = 512.0) -> Surface:
    """Read a model file with trimesh, all its parts as one surface, with its colours and textures.

    The surface is in the file's own frame and unit, polygons cut into triangles. Materials give a
    face its diffuse colour; vertex colours are averaged over the corners. Textures are looked for
    beside the file and below, never elsewhere; a missing one leaves the diffuse colour. Raises
    `MeshError` if the file can't be read, is larger than the limit, in 10⁶ bytes, or has no triangle.
    """
    path = Path(path)
    _check_suffix(path.suffix, str(path))
    try:
        with path.open("rb") as stream:
            data = _read_bounded(stream, str(path), largest_megabytes)
    except OSError as error:
        raise MeshError(f"{path} can't be read: {error.strerror}.") from error
    return _surface(data, str(path), path.suffix, FolderCompanions(path))


def read_open_file(
    stream: BinaryIO, name: str, suffix: str, largest_megabytes: float = 512.0
) -> Surface:
    """Read a model as `read_model` does from an open file, which brings no textures beside it.

    `suffix` is its format, such as ``.obj``. Raises `MeshError` also if the file gives text.
    """
    _check_suffix(suffix, name)
    data = _read_bounded(stream, name, largest_megabytes)
    return _surface(data, name, suffix, Companions())


def surface_from_archive(data: bytes, name: str, archive: ZipFile) -> Surface:
    """Read a member of a zip archive as `read_model` does, its textures from its own folder there."""
    return _surface(data, name, Path(name).suffix, ArchiveCompanions(archive, name))


def _check_suffix(suffix: str, name: str) -> None:
    if why := why_unreadable(suffix):
        raise MeshError(f"{name} {why}")


def _read_bounded(stream: BinaryIO, name: str, largest_megabytes: float) -> bytes:
    data = stream.read(int(largest_megabytes * 1e6) + 1)
    if not isinstance(data, bytes):
        raise MeshError(f'{name} gives text; open it with mode "rb".')
    if not data:
        raise MeshError(f"{name} is empty.")
    if len(data) > largest_megabytes * 1e6:
        raise MeshError(
            f"{name} has more than {largest_megabytes:g} MB, which are allowed "
            "(meshes.largest_megabytes)."
        )
    return data


def _surface(data: bytes, name: str, suffix: str, companions: Companions) -> Surface:
    kind = suffix[1:].lower()
    if kind in _TEXT_KINDS:
        data = data.removeprefix(codecs.BOM_UTF8)
    # A parser fed with a broken file may fail in any way.
    try:
        if kind == "obj":
            return join_parts(read_obj(data, companions))
        found = _read(data, kind, companions)
    except Exception as error:
        raise MeshError(f"{name} can't be read as {kind.upper()}: {reason_of(error)}.") from error
    return surface_of_trimesh(found, name)


def _read(data: bytes, kind: str, companions: Companions) -> Any:
    """Give a ``trimesh.Scene`` or ``trimesh.Trimesh`` as the file means it; errors give the reason alone."""
    import trimesh

    if kind == "off":
        return read_off(data)
    if kind == "3mf":
        return trimesh.Trimesh(*read_3mf(data), process=False)
    if kind in _CHECKED:
        data = _CHECKED[kind](data)
    else:
        document = gltf_document(data, kind)
        check_gltf(document, len(data))
    resolver = as_resolver(companions)
    scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, resolver=resolver, process=False)
    if kind not in _CHECKED:
        add_wraps(scene, document)
    return scene
