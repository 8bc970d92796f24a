"""3MF files: a zip archive of XML, read without their colours.

3D Manufacturing Format, core specification 1.3 and production extension 1.1 (3mf.io). trimesh's reader
puts all shapes of a file of the archive wherever one of them stands.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.vectors import product
from visuohaptic.meshes.limits import check_parts, check_xml_size, parse_xml
from visuohaptic.meshes.polygons import check_corners

Key = tuple[str, str]
"""A file of the archive, and the id of an object in it."""

_MODEL = "3d/3dmodel.model"
_MOST_FILES = 5_000


@dataclass(frozen=True)
class _Object:
    vertices: FloatArray
    faces: IntArray
    components: list[tuple[Key, FloatArray]]


def read_3mf(data: bytes) -> tuple[FloatArray, IntArray]:
    """Read all that a 3MF file builds, its parts where they stand: vertices (v, 3) and faces (f, 3).

    Vertices are in the file's own frame and unit. Raises `MeshError`, with the reason alone, if the
    file unpacks to too much, places too many parts, or refers to what it does not hold.
    """
    with ZipFile(io.BytesIO(data)) as archive:
        _check_archive(archive)
        roots = {
            name.lower(): parse_xml(archive.read(name))
            for name in archive.namelist()
            if name.lower().endswith(".model")
        }
    if _MODEL not in roots:
        raise MeshError("it holds no 3D/3dmodel.model")
    objects = {
        (file, one.get("id", "")): _read_object(one, file)
        for file, root in roots.items()
        for one in root.iter("{*}object")
    }
    return _place(objects, _references(roots[_MODEL], "{*}build/{*}item", _MODEL))


def _check_archive(archive: ZipFile) -> None:
    files = archive.infolist()
    if len(files) > _MOST_FILES:
        raise MeshError(f"it holds {len(files)} files; {_MOST_FILES} are allowed")
    # No more than these sizes is ever unpacked; other ways of packing may ask for any memory.
    check_xml_size(sum(file.file_size for file in files))
    if any(file.compress_type not in {ZIP_STORED, ZIP_DEFLATED} for file in files):
        raise MeshError("it is packed in a way that 3MF does not have")


def _read_object(element: Any, file: str) -> _Object:
    vertices = _rows(element, "{*}mesh/{*}vertices/{*}vertex", ("x", "y", "z"), np.float64)
    faces = _rows(element, "{*}mesh/{*}triangles/{*}triangle", ("v1", "v2", "v3"), np.int64)
    check_corners(faces.ravel(), len(vertices))
    return _Object(vertices, faces, _references(element, "{*}components/{*}component", file))


def _rows(element: Any, path: str, names: tuple[str, ...], kind: Any) -> NDArray[Any]:
    rows = [[one.get(name) for name in names] for one in element.iterfind(path)]
    return np.array(rows, dtype=kind).reshape(-1, 3)


def _references(element: Any, path: str, file: str) -> list[tuple[Key, FloatArray]]:
    return [(_key(one, file), _transform(one)) for one in element.iterfind(path)]


def _key(element: Any, file: str) -> Key:
    elsewhere = [text for name, text in element.attrib.items() if name.endswith("}path")]
    return (elsewhere[0].strip("/").lower() if elsewhere else file), element.get("objectid", "")


def _transform(element: Any) -> FloatArray:
    """Give a matrix (4, 4) for row vectors."""
    matrix, numbers = np.eye(4), element.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()
    matrix[:, :3] = np.array(numbers, dtype=np.float64).reshape(4, 3)
    return matrix


def _place(
    objects: dict[Key, _Object], built: list[tuple[Key, FloatArray]]
) -> tuple[FloatArray, IntArray]:
    placed, corners, waiting = [], 0, built[::-1]
    while waiting:
        key, matrix = waiting.pop()
        if key not in objects:
            raise MeshError(f"it places object {key[1]!r} of {key[0]!r}, which is not there")
        found = objects[key]
        placed.append((found, matrix))
        corners += len(found.vertices) + found.faces.size
        waiting += [(one, product(inner, matrix)) for one, inner in reversed(found.components)]
        check_parts(
            len(placed) + len(waiting), "parts or more, counted wherever one stands", corners
        )
    vertices, faces, count = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for found, matrix in placed:
        vertices.append(product(found.vertices, matrix[:3, :3]) + matrix[3, :3])
        faces.append(found.faces + count)
        count += len(found.vertices)
    return np.concatenate(vertices), np.concatenate(faces)
