"""COLLADA files (.dae): what their scene shows, as parts.

A node, shape or controller in use that is not read is refused by its name. Colours are stored ones
(sRGB), as programs write them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.turning import rotation_matrices
from visuohaptic.meshes.collada_document import (
    ColladaDocument,
    Look,
    integers,
    numbers,
    parse_collada,
    tag,
)
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.limits import check_parts
from visuohaptic.meshes.parts import Paint, Part
from visuohaptic.meshes.polygons import check_corners, triangulate
from visuohaptic.meshes.scenes import (
    fan_faces,
    placed,
    skinned,
    strip_faces,
)

_SURFACES = ("triangles", "polylist", "polygons", "tristrips", "trifans")
_MESH_DATA = {"source", "vertices", "extra", "lines", "linestrips"}
_CORNERS_A_NUMBER = 3  # what a polygon that is cut into a fan has at most
_HARMLESS = {"asset", "extra", "instance_camera", "instance_light"}
_LONGEST_SHOWN = 80


@dataclass(frozen=True)
class _Shown:
    """An instance of a geometry or controller, and the matrix (4, 4) of the node where it stands."""

    instance: Any
    matrix: FloatArray
    place: str


@dataclass(frozen=True)
class _Column:
    """An input of a primitive: what it is, its numbers, which index of a corner names them, its set."""

    semantic: str
    source: Any
    offset: int
    number: int


@dataclass(frozen=True)
class _Binding:
    """The material of a symbol, and the set of image coordinates that each of its names means."""

    material: str
    sets: dict[str, int]


def read_collada(data: bytes, companions: Companions) -> list[Part]:
    """Read what the scene of a COLLADA file shows, each mesh where its nodes put it.

    Parts are in the file's frame and unit; `companions.up_axis` is the axis that the file turns up. Skins
    and morph targets are applied as the nodes stand. Raises `MeshError`, with the reason only, if the
    file is broken, shows too much, or uses what is not read.
    """
    root = parse_collada(data)
    del data
    document = ColladaDocument(root, companions)
    companions.up_axis = document.up_axis
    shown, worlds = _scene(document)
    return [part for one in shown for part in _parts(document, one, worlds)]


def _scene(document: ColladaDocument) -> tuple[list[_Shown], dict[Any, FloatArray]]:
    """Return what the scene shows, and the matrix of each node where it stands first."""
    waiting = [(node, np.eye(4)) for node in _roots(document)][::-1]
    shown: list[_Shown] = []
    worlds: dict[Any, FloatArray] = {}
    parts, corners = len(waiting), 0
    while waiting:
        node, matrix = waiting.pop()
        place = f"node {(node.get('id') or node.get('name') or '')[:_LONGEST_SHOWN]!r}"
        for one in node:
            if tag(one) in _TRANSFORMS:
                matrix = matrix @ _transform(one, place)
        worlds.setdefault(node, matrix)
        inside, instances = _inside(document, node, place)
        shown += [_Shown(one, matrix, place) for one in instances]
        for one in instances:
            count, size = _size(document, one, place)
            parts, corners = parts + count, corners + size
        parts += len(inside)
        check_parts(parts, "parts or more, counted wherever one stands", corners)
        waiting += [(child, matrix) for child in inside[::-1]]
    return shown, worlds


def _roots(document: ColladaDocument) -> list[Any]:
    instance = document.root.find("{*}scene/{*}instance_visual_scene")
    if instance is not None:
        scene = document.referred(instance, "visual_scene", "the scene")
        return list(scene.iterfind("{*}node"))
    scenes = list(document.root.iterfind("{*}library_visual_scenes/{*}visual_scene"))
    if len(scenes) != 1:
        raise MeshError(f"it names no scene and has {len(scenes)}; one is needed")
    return list(scenes[0].iterfind("{*}node"))


def _inside(document: ColladaDocument, node: Any, place: str) -> tuple[list[Any], list[Any]]:
    """Return the nodes below a node and the shapes that it shows; of a hidden node none."""
    nodes, instances = [], []
    hidden = node.iterfind("{*}extra/{*}technique/{*}visibility")
    if any((one.text or "").strip().lower() in {"0", "false"} for one in hidden):
        return [], []
    for one in node:
        kind = tag(one)
        if kind == "node":
            nodes.append(one)
        elif kind == "instance_node":
            nodes.append(document.referred(one, "node", place))
        elif kind in {"instance_geometry", "instance_controller"}:
            instances.append(one)
        elif kind not in _HARMLESS and kind not in _TRANSFORMS:
            raise MeshError(f"{place} has {kind[:_LONGEST_SHOWN]}, which is not read")
    return nodes, instances


def _transform(element: Any, place: str) -> FloatArray:
    kind = tag(element)
    values = numbers(element.text, f"{kind} of {place}")
    count, matrix_of = _TRANSFORMS[kind]
    if len(values) != count:
        raise MeshError(f"{place} has {kind} of {len(values)} numbers; {count} are needed")
    return matrix_of(values)


def _translation(values: FloatArray) -> FloatArray:
    matrix = np.eye(4)
    matrix[:3, 3] = values
    return matrix


def _rotation(values: FloatArray) -> FloatArray:
    half = np.radians(values[3]) / 2
    length = np.linalg.norm(values[:3])
    axis = values[:3] / length if length > 0 else values[:3]
    matrix = np.eye(4)
    matrix[:3, :3] = rotation_matrices(np.array([[*(np.sin(half) * axis), np.cos(half)]]))[0]
    return matrix


def _look_at(values: FloatArray) -> FloatArray:
    eye, interest, up = values.reshape(3, 3)
    back = eye - interest
    right = np.cross(up, back)
    axes = np.array([right, np.cross(back, right), back])
    matrix = np.eye(4)
    matrix[:3, :3] = (axes / np.linalg.norm(axes, axis=1, keepdims=True)).T
    matrix[:3, 3] = eye
    return matrix


_TRANSFORMS: dict[str, tuple[int, Callable[[FloatArray], FloatArray]]] = {
    "matrix": (16, lambda values: values.reshape(4, 4)),
    "translate": (3, _translation),
    "rotate": (4, _rotation),
    "scale": (3, lambda values: np.diag([*values, 1.0])),
    "lookat": (9, _look_at),
}


def _size(document: ColladaDocument, instance: Any, place: str) -> tuple[int, int]:
    """Return how many primitives an instance shows, and how many corners at most."""
    geometry, _ = _geometry(document, instance, place)
    primitives = list(geometry.iter(*(f"{{*}}{kind}" for kind in _SURFACES)))
    # One text at a time: a primitive's is as large as its part of the file.
    counts = (
        (one.text or "").count(" ") + 1
        for primitive in primitives
        for one in primitive.iterfind("{*}p")
    )
    return len(primitives), _CORNERS_A_NUMBER * sum(counts)


def _geometry(document: ColladaDocument, instance: Any, place: str) -> tuple[Any, list[Any]]:
    """Return the geometry that an instance shows, and the controllers that deform it, the first one first."""
    controllers: list[Any] = []
    if tag(instance) == "instance_geometry":
        return document.referred(instance, "geometry", place), controllers
    controller = document.referred(instance, "controller", place)
    while True:
        place = _place_of(controller)
        deformer = _deformer(controller)
        if deformer is None or controller in controllers:
            raise MeshError(f"{place} has neither skin nor morph, or deforms itself")
        controllers.insert(0, controller)
        inner = document.named("controller", (deformer.get("source") or "").strip()[1:])
        if inner is None:
            return document.referred(deformer, "geometry", place, "source"), controllers
        controller = inner


def _deformer(controller: Any) -> Any:
    return next((one for one in controller if tag(one) in {"skin", "morph"}), None)


def _place_of(element: Any) -> str:
    return f"{tag(element)} {(element.get('id') or '')[:_LONGEST_SHOWN]!r}"


def _parts(
    document: ColladaDocument, shown: _Shown, worlds: dict[Any, FloatArray]
) -> Iterator[Part]:
    geometry, controllers = _geometry(document, shown.instance, shown.place)
    place, matrix = _place_of(geometry), shown.matrix
    mesh = geometry.find("{*}mesh")
    if mesh is None:
        kinds = [tag(one) for one in geometry if tag(one) not in _HARMLESS]
        raise MeshError(
            f"{place} is of kind {(kinds or ['none'])[0][:_LONGEST_SHOWN]}; mesh is needed"
        )
    positions = _positions(document, mesh, place)
    for controller in controllers:
        deformer, where = _deformer(controller), _place_of(controller)
        if tag(deformer) == "morph":
            positions = _morphed(document, deformer, positions, where)
        else:
            positions = _skinned(
                document, deformer, positions, _skeleton(document, shown, worlds), where
            )
            matrix = np.eye(4)
    bindings = _bindings(document, shown)
    for number, primitive in enumerate(one for one in mesh if tag(one) not in _MESH_DATA):
        kind = tag(primitive)
        where = f"{place}, {kind} {number}"
        if kind not in _SURFACES:
            raise MeshError(f"{where} is not read; {', '.join(_SURFACES)} are")
        part = _Primitive(document, primitive, where).part(positions, bindings)
        if len(part.faces):
            yield from placed(part, matrix[None])


def _positions(document: ColladaDocument, mesh: Any, place: str) -> FloatArray:
    position = mesh.find("{*}vertices/{*}input[@semantic='POSITION']")
    if position is None:
        raise MeshError(f"{place} has no vertices with a POSITION")
    rows = document.rows(document.referred(position, "source", place, "source"))
    if rows.shape[1] != 3:
        raise MeshError(f"{place} has positions of {rows.shape[1]} numbers; 3 are needed")
    return rows


def _inputs(document: ColladaDocument, holder: Any, place: str) -> dict[str, Any]:
    """Return the sources of a controller's inputs by their semantics."""
    return {
        one.get("semantic", ""): document.referred(one, "source", place, "source")
        for one in ([] if holder is None else holder.iterfind("{*}input"))
    }


def _needed(found: dict[str, Any], names: Sequence[str], place: str) -> list[Any]:
    for name in names:
        if name not in found:
            raise MeshError(f"{place} has no input {name}")
    return [found[name] for name in names]


def _morphed(
    document: ColladaDocument, morph: Any, positions: FloatArray, place: str
) -> FloatArray:
    found = _inputs(document, morph.find("{*}targets"), place)
    targets, weights = _needed(found, ("MORPH_TARGET", "MORPH_WEIGHT"), place)
    pairs = list(zip(document.words(targets), document.rows(weights)[:, 0], strict=True))
    relative = morph.get("method", "NORMALIZED") == "RELATIVE"
    moved = positions * (1.0 if relative else 1.0 - sum(weight for _, weight in pairs))
    for name, weight in pairs:
        if weight:
            target = document.named("geometry", name)
            mesh = None if target is None else target.find("{*}mesh")
            if mesh is None:
                raise MeshError(f"{place} has target {name[:_LONGEST_SHOWN]!r}, which is no mesh")
            to = _positions(document, mesh, _place_of(target))
            if to.shape != positions.shape:
                raise MeshError(
                    f"{place} has a target of {len(to)} vertices; {len(positions)} are needed"
                )
            moved = moved + weight * to
    return moved


def _skeleton(
    document: ColladaDocument, shown: _Shown, worlds: dict[Any, FloatArray]
) -> dict[str, FloatArray]:
    """Return the matrices of the nodes that a skin may name as joints, by id, name and sid."""
    roots = [
        document.named("node", (one.text or "").strip().removeprefix("#"))
        for one in shown.instance.iterfind("{*}skeleton")
    ]
    below = {node for root in roots if root is not None for node in root.iter("{*}node")}
    found: dict[str, FloatArray] = {}
    # A name below the skeleton's own roots goes before the same one elsewhere.
    for nodes in (worlds.keys() - below, worlds.keys() & below):
        for key in ("name", "id", "sid"):
            found |= {node.get(key): worlds[node] for node in nodes if node.get(key)}
    return found


def _skinned(
    document: ColladaDocument,
    skin: Any,
    positions: FloatArray,
    joints: dict[str, FloatArray],
    place: str,
) -> FloatArray:
    text = skin.findtext("{*}bind_shape_matrix")
    bind = np.eye(4) if text is None else numbers(text, place).reshape(4, 4)
    positions = np.einsum("ij,vj->vi", bind[:3, :3], positions) + bind[:3, 3]
    of_joints = _inputs(document, skin.find("{*}joints"), place)
    names, inverse = _needed(of_joints, ("JOINT", "INV_BIND_MATRIX"), place)
    inverses = document.rows(inverse).reshape(-1, 4, 4)
    weights = skin.find("{*}vertex_weights")
    named, shares = _needed(_inputs(document, weights, place), ("JOINT", "WEIGHT"), place)
    matrices = dict(zip(document.words(names), inverses, strict=True))
    for name, inverse_bind in matrices.items():
        if name not in joints:
            raise MeshError(f"{place} follows joint {name[:_LONGEST_SHOWN]!r}, which is no node")
        matrices[name] = joints[name] @ inverse_bind
    # Joint -1 is the shape itself.
    table = np.array([matrices[name] for name in document.words(named)] + [np.eye(4)])
    rows, joint, weight = _influences(document, weights, shares, len(positions), place)
    return skinned(positions, rows, np.where(joint == -1, len(table) - 1, joint), weight, table)


def _influences(
    document: ColladaDocument, weights: Any, shares: Any, vertices: int, place: str
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return for each influence on a vertex its row, its joint, and its weight."""
    offsets = {
        one.get("semantic"): int(one.get("offset", 0)) for one in weights.iterfind("{*}input")
    }
    counts = integers(weights.findtext("{*}vcount"), place)
    pairs = integers(weights.findtext("{*}v"), place)
    width = 1 + max(offsets.values())
    if counts.min(initial=0) < 0 or counts.sum() * width != len(pairs) or len(counts) > vertices:
        raise MeshError(
            f"{place} claims {counts.sum()} weights of {len(counts)} vertices, and {len(pairs)} numbers "
            f"for {vertices} are there"
        )
    pairs = pairs.reshape(-1, width)
    weight = _chosen(document.rows(shares), pairs[:, offsets["WEIGHT"]], place)[:, 0]
    return np.repeat(np.arange(len(counts)), counts), pairs[:, offsets["JOINT"]], weight


def _chosen(rows: FloatArray, index: IntArray, place: str) -> FloatArray:
    if index.size and (index.min() < 0 or index.max() >= len(rows)):
        raise MeshError(f"{place} names row {index.max()} of a source; {len(rows)} are there")
    return rows[index]


def _bindings(document: ColladaDocument, shown: _Shown) -> dict[str, _Binding]:
    return {
        one.get("symbol", ""): _Binding(
            document.referred(one, "material", shown.place, "target").get("id"),
            {
                bound.get("semantic", ""): int(bound.get("input_set", 0))
                for bound in one.iterfind("{*}bind_vertex_input")
            },
        )
        for one in shown.instance.iterfind(
            "{*}bind_material/{*}technique_common/{*}instance_material"
        )
    }


class _Primitive:
    """Triangles or polygons of a mesh, with the inputs of their corners."""

    def __init__(self, document: ColladaDocument, element: Any, place: str) -> None:
        self._document, self._element, self._place = document, element, place
        if element.find("{*}ph") is not None:
            raise MeshError(f"{place} has polygons with holes (ph), which are not read")
        self._columns = list(self._read_columns())
        width = 1 + max((one.offset for one in self._columns), default=0)
        rows = [integers(one.text, place) for one in element.iterfind("{*}p")]
        if any(len(one) % width for one in rows):
            raise MeshError(f"{place} has corners of {width} numbers each, and some are missing")
        self._lengths = np.array([len(one) // width for one in rows], dtype=np.int64)
        self._corners = np.concatenate([np.empty(0, np.int64), *rows]).reshape(-1, width)

    def _read_columns(self) -> Iterator[_Column]:
        for one in self._element.iterfind("{*}input"):
            offset, number = int(one.get("offset", 0)), int(one.get("set", 0))
            if one.get("semantic") != "VERTEX":
                source = self._document.referred(one, "source", self._place, "source")
                yield _Column(one.get("semantic", ""), source, offset, number)
                continue
            vertices = self._document.referred(one, "vertices", self._place, "source")
            yield _Column("VERTEX", None, offset, number)
            for inner in vertices.iterfind("{*}input"):
                source = self._document.referred(inner, "source", self._place, "source")
                yield _Column(inner.get("semantic", ""), source, offset, int(inner.get("set", 0)))

    def part(self, positions: FloatArray, bindings: dict[str, _Binding]) -> Part:
        """Return the triangles, with their colours or their image."""
        if not len(self._corners):
            return Part(positions, np.zeros((0, 3), dtype=np.int64))
        vertex = next((one for one in self._columns if one.semantic == "VERTEX"), None)
        if vertex is None:
            raise MeshError(f"{self._place} has no input VERTEX")
        named = self._corners[:, vertex.offset]
        try:
            check_corners(named, len(positions))
        except MeshError as error:
            raise MeshError(f"{self._place}: {error}") from error
        triangles = self._triangles(positions, named)
        look, sets = self._look(bindings)
        paint = self._paint(look, sets, triangles)
        return Part(positions, named[triangles], self._colours(look, triangles), paint)

    def _triangles(self, positions: FloatArray, named: IntArray) -> IntArray:
        """Return triangles (t, 3) of rows of the corners."""
        kind, count = tag(self._element), len(named)
        if kind == "triangles":
            if count % 3:
                raise MeshError(f"{self._place} has {count} corners, no multiple of 3")
            return np.arange(count).reshape(-1, 3)
        if kind in {"tristrips", "trifans"}:
            faces_of = strip_faces if kind == "tristrips" else fan_faces
            starts = np.cumsum(self._lengths) - self._lengths
            return np.concatenate(
                [np.empty((0, 3), np.int64)]
                + [
                    faces_of(np.arange(start, start + length))
                    for start, length in zip(starts, self._lengths, strict=True)
                    if length > 2
                ]
            )
        counts = self._lengths
        if kind == "polylist":
            counts = integers(self._element.findtext("{*}vcount"), self._place)
        if counts.min(initial=0) < 0 or counts.sum() != count:
            raise MeshError(
                f"{self._place}: polygons claim {counts.sum()} corners, and {count} are there"
            )
        return triangulate(positions, named, counts)[0]

    def _look(self, bindings: dict[str, _Binding]) -> tuple[Look, dict[str, int]]:
        symbol = self._element.get("material", "")
        if symbol in bindings:
            return self._document.look(bindings[symbol].material), bindings[symbol].sets
        # Some programs name the material itself.
        if self._document.named("material", symbol) is not None:
            return self._document.look(symbol), {}
        return Look(), {}

    def _paint(self, look: Look, sets: dict[str, int], triangles: IntArray) -> Paint | None:
        if look.image is None:
            return None
        columns = {one.number: one for one in self._columns if one.semantic == "TEXCOORD"}
        if not columns:
            self._document.companions.notes.append(
                f"has an image on {self._place}, which has no TEXCOORD; the image is not read"
            )
            return None
        column = columns.get(sets.get(look.coordinates, -1), columns[min(columns)])
        rows = self._document.rows(column.source)
        if rows.shape[1] < 2:
            raise MeshError(f"{self._place} has image coordinates of {rows.shape[1]} numbers")
        corners = _chosen(rows, self._corners[:, column.offset], self._place)[:, :2]
        return Paint(look.image, corners[triangles], look.wraps)

    def _colours(self, look: Look, triangles: IntArray) -> NDArray[np.uint8] | None:
        """Return the mean of the corners' colours, unless all are white, or else the material's colour."""
        columns = [one for one in self._columns if one.semantic == "COLOR"]
        if columns:
            column = min(columns, key=lambda one: one.number)
            rows = self._document.rows(column.source)[:, :3]
            corners = _chosen(rows, self._corners[:, column.offset], self._place)
            largest = 255.0 if corners.max(initial=0) > 1 else 1.0
            if corners.shape[1] == 3 and (corners != largest).any():
                stored = np.clip(np.nan_to_num(corners / largest), 0.0, 1.0)[triangles]
                return np.rint(255.0 * stored.mean(axis=1)).astype(np.uint8)
        if look.colour is None:
            return None
        colour = np.rint(255.0 * np.array(look.colour)).astype(np.uint8)
        return np.tile(colour, (len(triangles), 1))
