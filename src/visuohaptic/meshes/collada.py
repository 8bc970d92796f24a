"""What a COLLADA file (.dae) claims to hold, checked before it is parsed as a model."""

from __future__ import annotations

import io
from collections import Counter, defaultdict
from typing import Any
from zipfile import is_zipfile

from visuohaptic.errors import MeshError
from visuohaptic.meshes.xml_claims import check_placed, parse_xml

MOST_ELEMENTS = 200_000
"""Elements other than the polygons of old files, which have one each."""

_PRIMITIVES = ("triangles", "tristrips", "trifans", "polylist", "polygons")
_POLYGONS = {"p", "ph", "h"}
_CORNERS_A_NUMBER = 3  # what a polygon that is cut into a fan has at most
_WHOLE = "model"


def check_collada(data: bytes) -> None:
    """Refuse a file that claims more than it holds, or asks for more than is bounded.

    Raises `MeshError` with the reason alone, and ``lxml.etree.XMLSyntaxError``.
    """
    if is_zipfile(io.BytesIO(data)):
        raise MeshError("it is a zip archive; unpack it first")
    root = parse_xml(data)
    tags = Counter(element.tag.rpartition("}")[2] for element in root.iter())
    elements = sum(count for tag, count in tags.items() if tag not in _POLYGONS)
    if elements > MOST_ELEMENTS:
        raise MeshError(f"it has {elements} elements; {MOST_ELEMENTS} are allowed")
    for polygons in root.iter("{*}polylist"):
        _check_polygons(polygons)
    _check_nodes(root)


def _check_polygons(polygons: Any) -> None:
    claimed = [int(count) for count in (polygons.findtext("{*}vcount") or "").split()]
    held = _numbers(polygons)
    if min(claimed, default=0) < 0 or sum(claimed) > held:
        raise MeshError(f"polygons claim {sum(claimed)} corners, and {held} numbers are there")


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
