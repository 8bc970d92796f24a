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

from visuohaptic.errors import MeshError
from visuohaptic.geometry.arrays import Floats, Integers
from visuohaptic.geometry.vectors import product
from visuohaptic.meshes.xml_claims import check_placed, check_size, parse_xml

Key = tuple[str, str]
"""A file of the archive, and the id of an object in it."""

_MODEL = "3d/3dmodel.model"
_MOST_FILES = 5_000
_WHOLE: Key = ("", "")


@dataclass(frozen=True)
class _Object:
    vertices: Floats
    faces: Integers
    components: list[tuple[Key, Floats]]


def read_3mf(data: bytes) -> tuple[Floats, Integers]:
    """Read all that a 3MF file builds, its parts where they stand: vertices (v, 3) and faces (f, 3).

    Vertices are in the file's own frame and unit. Raises `MeshError`, with the reason alone, if the
    file unpacks to too much, places too many parts, or refers to what it does not hold. What is no
    zip archive or no XML fails as these do.
    """
    with ZipFile(io.BytesIO(data)) as archive:
        _check_archive(archive)
        objects = _read_objects(archive)
    check_placed(
        {key: [one for one, _ in found.components] for key, found in objects.items()},
        {key: (0, len(found.vertices) + found.faces.size) for key, found in objects.items()},
        _WHOLE,
    )
    return _place(objects)


def _check_archive(archive: ZipFile) -> None:
    files = archive.infolist()
    if len(files) > _MOST_FILES:
        raise MeshError(f"it holds {len(files)} files; {_MOST_FILES} are allowed")
    # No more than these sizes is ever unpacked; other ways of packing may ask for any memory.
    check_size(sum(file.file_size for file in files))
    if any(file.compress_type not in {ZIP_STORED, ZIP_DEFLATED} for file in files):
        raise MeshError("it is packed in a way that 3MF does not have")


def _read_objects(archive: ZipFile) -> dict[Key, _Object]:
    names = {name.lower(): name for name in archive.namelist()}
    if _MODEL not in names:
        raise MeshError("it holds no 3D/3dmodel.model")
    objects: dict[Key, _Object] = {}
    read, waiting = set(), [_MODEL]
    while waiting:
        file = waiting.pop()
        if file in read:
            continue
        read.add(file)
        if file not in names:
            raise MeshError(f"it refers to {file!r}, which it does not hold")
        root = parse_xml(archive.read(names[file]))
        found = {
            (file, one.get("id", "")): _read_object(one, file) for one in root.iter("{*}object")
        }
        if file == _MODEL:
            found[_WHOLE] = _assembly(_references(root, "{*}build/{*}item", file))
        objects |= found
        waiting += [path for one in found.values() for (path, _), _ in one.components]
    placed = {key for one in objects.values() for key, _ in one.components}
    if lost := sorted(placed - set(objects)):
        raise MeshError(f"it places object {lost[0][1]!r} of {lost[0][0]!r}, which is not there")
    return objects


def _assembly(components: list[tuple[Key, Floats]]) -> _Object:
    return _Object(np.empty((0, 3)), np.empty((0, 3), np.int64), components)


def _read_object(element: Any, file: str) -> _Object:
    vertices = _rows(element, "{*}mesh/{*}vertices/{*}vertex", ("x", "y", "z"), np.float64)
    faces = _rows(element, "{*}mesh/{*}triangles/{*}triangle", ("v1", "v2", "v3"), np.int64)
    if faces.size and not 0 <= faces.min() <= faces.max() < len(vertices):
        raise MeshError(
            f"object {element.get('id')!r} has faces of the vertices {faces.min()} to {faces.max()}, "
            f"and {len(vertices)} vertices"
        )
    return _Object(vertices, faces, _references(element, "{*}components/{*}component", file))


def _rows(element: Any, path: str, names: tuple[str, str, str], kind: Any) -> NDArray[Any]:
    first, second, third = names
    rows = [(one.get(first), one.get(second), one.get(third)) for one in element.iterfind(path)]
    return np.array(rows, dtype=kind).reshape(-1, 3)


def _references(element: Any, path: str, file: str) -> list[tuple[Key, Floats]]:
    return [(_key(one, file), _transform(one)) for one in element.iterfind(path)]


def _key(element: Any, file: str) -> Key:
    elsewhere = [text for name, text in element.attrib.items() if name.endswith("}path")]
    return (elsewhere[0].strip("/").lower() if elsewhere else file), element.get("objectid", "")


def _transform(element: Any) -> Floats:
    """Give a matrix (4, 4) for row vectors."""
    matrix, numbers = np.eye(4), element.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()
    if len(numbers) != 12:
        raise MeshError(f"a transform has {len(numbers)} numbers; 12 are needed")
    matrix[:, :3] = np.array(numbers, dtype=np.float64).reshape(4, 3)
    return matrix


def _place(objects: dict[Key, _Object]) -> tuple[Floats, Integers]:
    vertices, faces, count = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    waiting = [(_WHOLE, np.eye(4))]
    while waiting:
        key, matrix = waiting.pop()
        found = objects[key]
        vertices.append(product(found.vertices, matrix[:3, :3]) + matrix[3, :3])
        faces.append(found.faces + count)
        count += len(found.vertices)
        waiting += [(one, product(inner, matrix)) for one, inner in reversed(found.components)]
    return np.concatenate(vertices), np.concatenate(faces)
