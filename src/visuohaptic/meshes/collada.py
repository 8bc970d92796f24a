"""COLLADA files (.dae), checked before they are parsed as models and their concave polygons cut."""

from __future__ import annotations

import io
from collections import Counter, defaultdict
from typing import Any
from zipfile import is_zipfile

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.limits import check_parts, parse_xml
from visuohaptic.meshes.polygons import check_corners, cuts, fan

MOST_ELEMENTS = 200_000
"""Elements other than the polygons of old files, which have one each."""

_PRIMITIVES = ("{*}triangles", "{*}polylist", "{*}polygons")
_LEFT_OUT = {"tristrips", "trifans", "ph"}
_CORNERS_A_NUMBER = 3  # what a polygon that is cut into a fan has at most


def checked_collada(data: bytes) -> bytes:
    """Give the file, or an equal one whose concave polygons are triangles.

    Raises `MeshError` with the reason alone, if it claims more than it holds, asks for more than is
    bounded, or has what pycollada leaves out; ``lxml.etree.XMLSyntaxError`` if it is no XML.
    """
    from lxml import etree

    # pycollada would read the archive, of which nothing is checked, even within a comment.
    if is_zipfile(io.BytesIO(data)):
        raise MeshError("it is a zip archive; unpack it first")
    root = parse_xml(data)
    tags = Counter(etree.QName(element).localname for element in root.iter())
    elements = tags.total() - tags["p"]
    if elements > MOST_ELEMENTS:
        raise MeshError(f"it has {elements} elements; {MOST_ELEMENTS} are allowed")
    if left_out := sorted(_LEFT_OUT & set(tags)):
        raise MeshError(f"it has {left_out[0]}, which are not read; export triangles")
    _check_nodes(root)
    changed = [_cut_mesh(mesh) for mesh in root.iter("{*}mesh")]
    return bytes(etree.tostring(root)) if any(changed) else data


def _check_nodes(root: Any) -> None:
    """Refuse scenes of too many parts, each counted wherever a node stands."""
    shapes: dict[str, tuple[int, int]] = {}
    for geometry in root.iter("{*}geometry"):
        numbers = [len((one.text or "").split()) for one in geometry.iter("{*}p")]
        primitives = sum(1 for _ in geometry.iter(*_PRIMITIVES))
        shapes[geometry.get("id", "")] = primitives, _CORNERS_A_NUMBER * sum(numbers)
    named = defaultdict(list)
    for node in root.iter("{*}node"):
        named[node.get("id", "")].append(node)
    waiting = [node for scene in root.iter("{*}visual_scene") for node in scene.iterfind("{*}node")]
    parts, corners = len(waiting), 0
    while waiting:
        node = waiting.pop()
        inside = list(node.iterfind("{*}node"))
        for name in _referred(node, "{*}instance_node"):
            inside += named[name]
        shown = [shapes.get(name, (0, 0)) for name in _referred(node, "{*}instance_geometry")]
        parts += len(inside) + sum(count for count, _ in shown)
        corners += sum(count for _, count in shown)
        check_parts(parts, "parts or more, counted wherever one stands", corners)
        waiting += inside


def _referred(node: Any, path: str) -> list[str]:
    return [one.get("url", "").removeprefix("#") for one in node.iterfind(path)]


def _cut_mesh(mesh: Any) -> bool:
    """Put triangles in the place of concave polygons; tell whether there are any."""
    named = {one.get("id"): one for one in mesh}
    points: dict[str, FloatArray] = {}
    changed = False
    for primitive in mesh.iterchildren(*_PRIMITIVES):
        vertex = primitive.find("{*}input[@semantic='VERTEX']")
        if vertex is not None and primitive.find("{*}p") is not None:
            source = vertex.get("source")[1:]
            if source not in points:
                points[source] = _points(source, named)
            changed |= _cut(primitive, int(vertex.get("offset", 0)), points[source])
    return changed


def _cut(primitive: Any, offset: int, points: FloatArray) -> bool:
    inputs = [int(one.get("offset", 0)) for one in primitive.iterfind("{*}input")]
    texts = primitive.findall("{*}p")
    rows = [_array(one.text, int).reshape(-1, 1 + max(inputs)) for one in texts]
    together = np.concatenate(rows)
    check_corners(together[:, offset], len(points))
    kind = primitive.tag.rpartition("}")[2]
    if kind == "triangles":
        return False
    counts = np.array([len(one) for one in rows], dtype=np.int64)
    if kind == "polylist":
        counts = _array(primitive.findtext("{*}vcount"), int)
    if counts.min(initial=0) < 0 or counts.sum() != len(together):
        raise MeshError(f"polygons claim {counts.sum()} corners, and {len(together)} are there")
    cut = cuts(points, together[:, offset], counts)
    if not cut:
        return False
    starts = (np.cumsum(counts) - counts).tolist()
    triangles = np.concatenate(
        [
            start + cut.get(place, fan(count))
            for place, (start, count) in enumerate(zip(starts, counts.tolist(), strict=True))
        ]
    )
    for one in primitive.findall("{*}vcount") + texts[1:]:
        primitive.remove(one)
    primitive.tag = primitive.tag.replace(kind, "triangles")
    primitive.set("count", str(len(triangles)))
    texts[0].text = " ".join(map(str, together[triangles.ravel()].ravel().tolist()))
    return True


def _points(name: str, named: dict[str, Any]) -> FloatArray:
    found = named[name]
    position = found.find("{*}input[@semantic='POSITION']")
    source = found if position is None else named[position.get("source")[1:]]
    accessor = source.find("{*}technique_common/{*}accessor")
    numbers = _array(source.findtext("{*}float_array"), float)
    return numbers.reshape(-1, int(accessor.get("stride", 1)))[:, :3]


def _array(text: str | None, kind: type[int | float]) -> NDArray[Any]:
    # NumPy would give every word the room of the longest.
    return np.array([kind(word) for word in (text or "").split()], dtype=kind)
