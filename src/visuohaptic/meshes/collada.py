"""COLLADA files (.dae), checked before they are parsed as models and their concave polygons cut."""

from __future__ import annotations

import io
from collections import Counter, defaultdict
from collections.abc import Mapping
from typing import Any
from zipfile import is_zipfile

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MeshError
from visuohaptic.geometry.arrays import Floats, Integers
from visuohaptic.meshes.polygons import check_corners, cuts
from visuohaptic.meshes.xml_claims import check_placed, parse_xml

MOST_ELEMENTS = 200_000
"""Elements other than the polygons of old files, which have one each."""

_PRIMITIVES = ("triangles", "tristrips", "trifans", "polylist", "polygons")
_POLYGONS = {"p", "ph", "h"}
_LEFT_OUT = {"tristrips", "trifans", "ph"}
_CORNERS_A_NUMBER = 3  # what a polygon that is cut into a fan has at most
_WHOLE = "model"


def checked_collada(data: bytes) -> bytes:
    """Give the file, or an equal one whose concave polygons are triangles.

    Raises `MeshError` with the reason alone, if it claims more than it holds, asks for more than is
    bounded, or has what pycollada leaves out; ``lxml.etree.XMLSyntaxError`` if it is no XML.
    """
    from lxml import etree

    if is_zipfile(io.BytesIO(data)):
        raise MeshError("it is a zip archive; unpack it first")
    root = parse_xml(data)
    tags = Counter(element.tag.rpartition("}")[2] for element in root.iter())
    elements = sum(count for tag, count in tags.items() if tag not in _POLYGONS)
    if elements > MOST_ELEMENTS:
        raise MeshError(f"it has {elements} elements; {MOST_ELEMENTS} are allowed")
    if left_out := sorted(_LEFT_OUT & set(tags)):
        raise MeshError(f"it has {left_out[0]}, which are not read; export triangles")
    for polygons in root.iter("{*}polylist"):
        _check_polygons(polygons)
    _check_nodes(root)
    changed = [_cut_mesh(mesh) for mesh in root.iter("{*}mesh")]
    return bytes(etree.tostring(root)) if any(changed) else data


def _check_polygons(polygons: Any) -> None:
    claimed = [int(count) for count in (polygons.findtext("{*}vcount") or "").split()]
    held = _numbers(polygons)
    if min(claimed, default=0) < 0 or sum(claimed) * _stride(polygons) != held:
        raise MeshError(f"polygons claim {sum(claimed)} corners, and {held} numbers are there")


def _stride(primitive: Any) -> int:
    """Give how many numbers a corner has."""
    return 1 + max((int(one.get("offset", 0)) for one in primitive.iterfind("{*}input")), default=0)


def _cut_mesh(mesh: Any) -> bool:
    """Put triangles in the place of concave polygons; tell whether there are any."""
    named = {one.get("id"): one for one in mesh}
    points: dict[str, Floats] = {}
    changed = False
    for primitive in mesh.iterchildren("{*}triangles", "{*}polylist", "{*}polygons"):
        vertex = primitive.find("{*}input[@semantic='VERTEX']")
        if vertex is not None and primitive.find("{*}p") is not None:
            source = vertex.get("source")[1:]
            if source not in points:
                points[source] = _points(source, named)
            changed |= _cut(primitive, int(vertex.get("offset", 0)), points[source])
    return changed


def _cut(primitive: Any, offset: int, points: Floats) -> bool:
    stride = _stride(primitive)
    texts = primitive.findall("{*}p")
    rows = [_array(one.text, int).reshape(-1, stride) for one in texts]
    together = np.concatenate(rows)
    corners = together[:, offset]
    check_corners(corners, len(points))
    kind = primitive.tag.rpartition("}")[2]
    if kind == "triangles":
        return False
    if kind == "polylist":
        counts = _array(primitive.findtext("{*}vcount"), int)
    else:
        counts = np.array([len(one) for one in rows], dtype=np.int64)
    cut = cuts(points, corners, counts)
    starts = np.cumsum(counts) - counts
    pieces = [
        together[start : start + count][row]
        for place, (start, count) in enumerate(zip(starts, counts, strict=True))
        for row in cut.get(place, [range(count)])
    ]
    if cut and kind == "polylist":
        primitive.find("{*}vcount").text = " ".join(str(len(one)) for one in pieces)
        texts[0].text = _text(np.concatenate(pieces))
    elif cut:
        for one in texts:
            primitive.remove(one)
        for one in pieces:
            added = primitive.makeelement(texts[0].tag)
            added.text = _text(one)
            primitive.append(added)
    return bool(cut)


def _points(name: str, named: Mapping[str, Any]) -> Floats:
    found = named[name]
    position = found.find("{*}input[@semantic='POSITION']")
    source = found if position is None else named[position.get("source")[1:]]
    accessor = source.find("{*}technique_common/{*}accessor")
    numbers = _array(source.findtext("{*}float_array"), float)
    return numbers.reshape(-1, int(accessor.get("stride", 1)))[:, :3]


def _array(text: str | None, kind: type[int | float]) -> NDArray[Any]:
    # NumPy would give every word the room of the longest.
    return np.array([kind(word) for word in (text or "").split()], dtype=kind)


def _text(rows: Integers) -> str:
    return " ".join(map(str, rows.ravel().tolist()))


def _check_nodes(root: Any) -> None:
    shapes: dict[str, tuple[int, int]] = defaultdict(lambda: (0, 0))
    for geometry in root.iter("{*}geometry"):
        found = [one for tag in _PRIMITIVES for one in geometry.iter(f"{{*}}{tag}")]
        count, corners = shapes[geometry.get("id", "")]
        corners += _CORNERS_A_NUMBER * sum(_numbers(one) for one in found)
        shapes[geometry.get("id", "")] = (count + len(found), corners)
    nodes = list(root.iter("{*}node"))
    named = defaultdict(list)
    for node in nodes:
        named[node.get("id", "")].append(node)
    inside: dict[Any, list[Any]] = {
        node: [
            *node.iterfind("{*}node"),
            *(one for name in _referred(node, "instance_node") for one in named[name]),
        ]
        for node in nodes
    }
    sizes = {
        node: _total(shapes[name] for name in _referred(node, "instance_geometry"))
        for node in nodes
    }
    inside[_WHOLE] = [
        node for scene in root.iter("{*}visual_scene") for node in scene.iterfind("{*}node")
    ]
    check_placed(inside, sizes, _WHOLE)


def _referred(node: Any, tag: str) -> list[str]:
    return [one.get("url", "").removeprefix("#") for one in node.iterfind(f"{{*}}{tag}")]


def _numbers(primitive: Any) -> int:
    return sum(len((indices.text or "").split()) for indices in primitive.iter("{*}p"))


def _total(sizes: Any) -> tuple[int, int]:
    shapes = corners = 0
    for one_shapes, one_corners in sizes:
        shapes, corners = shapes + one_shapes, corners + one_corners
    return shapes, corners
