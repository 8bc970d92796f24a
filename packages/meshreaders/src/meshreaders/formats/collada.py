"""Read the scene of a COLLADA file (.dae) as parts.

An unsupported node, shape or controller that the scene uses raises an error with its name. Colours are taken as sRGB,
as programs write them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.base.rotations import rotation_matrices
from meshreaders.companions import Companions
from meshreaders.formats.collada_document import (
    Appearance,
    ColladaDocument,
    integers,
    numbers,
    parse_collada,
    tag,
)
from meshreaders.formats.limits import check_parts
from meshreaders.formats.scenes import (
    fan_faces,
    placed,
    skinned,
    strip_faces,
)
from meshreaders.parts import Paint, Part
from meshreaders.polygons import check_corners, triangulate

_SURFACES = ("triangles", "polylist", "polygons", "tristrips", "trifans")
_MESH_DATA = {"source", "vertices", "extra", "lines", "linestrips"}
# Largest number of triangle corners per stored index: a polygon may be cut into a fan.
_CORNERS_PER_NUMBER = 3
_HARMLESS = {"asset", "extra", "instance_camera", "instance_light"}
_LONGEST_SHOWN = 80
_MOST_CONTROLLERS = 16  # that deform one geometry in turn; programs write two, a morph below a skin


@dataclass(frozen=True)
class _SceneInstance:
    """An instance of a geometry or controller, with the matrix (4, 4) and label of its node."""

    instance: Any
    matrix: FloatArray
    label: str


@dataclass(frozen=True)
class _Column:
    """An input of a primitive: semantic, source of its numbers, offset of its index in a corner, and number of its set."""

    semantic: str
    source: Any
    offset: int
    number: int


@dataclass(frozen=True)
class _Binding:
    """The material of a symbol, and the number of the set of image coordinates per name."""

    material: str
    sets: dict[str, int]


def read_collada(data: bytes, companions: Companions) -> list[Part]:
    """Read the meshes in the scene of a COLLADA file, with the transforms of their nodes.

    Parts are in the file's frame and unit; `companions.up_axis` becomes the file's up axis. Skins and morph targets
    are applied in the pose of the nodes. Raises `MeshError` if the file is broken, has too many parts, or uses
    an unsupported element. The message has only the reason; the caller adds the name of the file.
    """
    root = parse_collada(data)
    del data
    document = ColladaDocument(root, companions)
    companions.up_axis = document.up_axis
    scene_instances, world_matrices = _scene(document)
    return [
        part
        for scene_instance in scene_instances
        for part in _parts(document, scene_instance, world_matrices)
    ]


def _scene(document: ColladaDocument) -> tuple[list[_SceneInstance], dict[Any, FloatArray]]:
    """Return the instances in the scene, and the matrix of the first occurrence of each node."""
    stack = [(node, np.eye(4)) for node in _roots(document)][::-1]
    scene_instances: list[_SceneInstance] = []
    world_matrices: dict[Any, FloatArray] = {}
    parts, corners = len(stack), 0
    while stack:
        node, matrix = stack.pop()
        label = _label_of_node(node)
        matrix = matrix @ _local(node, label)
        world_matrices.setdefault(node, matrix)
        children, instances = _children_and_instances(document, node, label)
        for instance in instances:
            scene_instances.append(_SceneInstance(instance, matrix, label))
            primitives, most_corners = _size(document, instance, label)
            parts, corners = parts + primitives, corners + most_corners
        parts += len(children)
        check_parts(parts, "parts or more, each counted per instance", corners)
        stack += [(child, matrix) for child in children[::-1]]
    return scene_instances, world_matrices


def _roots(document: ColladaDocument) -> list[Any]:
    instance = document.root.find("{*}scene/{*}instance_visual_scene")
    if instance is not None:
        scene = document.referred(instance, "visual_scene", "the scene")
        return list(scene.iterfind("{*}node"))
    scenes = list(document.root.iterfind("{*}library_visual_scenes/{*}visual_scene"))
    if len(scenes) != 1:
        raise MeshError(f"it names no scene and has {len(scenes)}; 1 is needed")
    return list(scenes[0].iterfind("{*}node"))


def _children_and_instances(
    document: ColladaDocument, node: Any, label: str
) -> tuple[list[Any], list[Any]]:
    """Return the child nodes and the shapes of a node; both empty if the node is hidden."""
    nodes, instances = [], []
    visibilities = node.iterfind("{*}extra/{*}technique/{*}visibility")
    if any((element.text or "").strip().lower() in {"0", "false"} for element in visibilities):
        return [], []
    for child in node:
        kind = tag(child)
        if kind == "node":
            nodes.append(child)
        elif kind == "instance_node":
            nodes.append(document.referred(child, "node", label))
        elif kind in {"instance_geometry", "instance_controller"}:
            instances.append(child)
        elif kind not in _HARMLESS and kind not in _TRANSFORMS:
            raise MeshError(f"{label} has {kind[:_LONGEST_SHOWN]}, which is not read")
    return nodes, instances


def _label_of_node(node: Any) -> str:
    return f"node {(node.get('id') or node.get('name') or '')[:_LONGEST_SHOWN]!r}"


def _local(node: Any, label: str) -> FloatArray:
    """Return the matrix (4, 4) from a node's frame to the frame of its parent."""
    matrix = np.eye(4)
    for child in node:
        if tag(child) in _TRANSFORMS:
            matrix = matrix @ _transform(child, label)
    return matrix


def _transform(element: Any, label: str) -> FloatArray:
    kind = tag(element)
    values = numbers(element.text, f"{kind} of {label}")
    count, matrix_of = _TRANSFORMS[kind]
    if len(values) != count:
        raise MeshError(f"{label} has {kind} of {len(values)} numbers; {count} are needed")
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


def _size(document: ColladaDocument, instance: Any, label: str) -> tuple[int, int]:
    """Return the number of primitives of an instance, and an upper bound of its corners."""
    geometry, _ = _geometry(document, instance, label)
    primitives = list(geometry.iter(*(f"{{*}}{kind}" for kind in _SURFACES)))
    # A generator: the text of a primitive is as large as its part of the file.
    counts = (
        (indices.text or "").count(" ") + 1
        for primitive in primitives
        for indices in primitive.iterfind("{*}p")
    )
    return len(primitives), _CORNERS_PER_NUMBER * sum(counts)


def _geometry(document: ColladaDocument, instance: Any, label: str) -> tuple[Any, list[Any]]:
    """Return the geometry of an instance, and its controllers in the order in which they deform the geometry."""
    controllers: list[Any] = []
    if tag(instance) == "instance_geometry":
        return document.referred(instance, "geometry", label), controllers
    controller = document.referred(instance, "controller", label)
    while True:
        label = _label_of(controller)
        deformer = _deformer(controller)
        if deformer is None or controller in controllers:
            raise MeshError(f"{label} has neither skin nor morph, or deforms itself")
        if len(controllers) == _MOST_CONTROLLERS:
            raise MeshError(
                f"{label} is one of more than {_MOST_CONTROLLERS} controllers that deform one another, which is not read"
            )
        controllers.insert(0, controller)
        inner = document.named("controller", (deformer.get("source") or "").strip()[1:])
        if inner is None:
            return document.referred(deformer, "geometry", label, "source"), controllers
        controller = inner


def _deformer(controller: Any) -> Any:
    return next((child for child in controller if tag(child) in {"skin", "morph"}), None)


def _label_of(element: Any) -> str:
    return f"{tag(element)} {(element.get('id') or '')[:_LONGEST_SHOWN]!r}"


def _parts(
    document: ColladaDocument, scene_instance: _SceneInstance, world_matrices: dict[Any, FloatArray]
) -> Iterator[Part]:
    geometry, controllers = _geometry(document, scene_instance.instance, scene_instance.label)
    label, matrix = _label_of(geometry), scene_instance.matrix
    mesh = geometry.find("{*}mesh")
    if mesh is None:
        kinds = [tag(child) for child in geometry if tag(child) not in _HARMLESS]
        raise MeshError(
            f"{label} is of kind {(kinds or ['none'])[0][:_LONGEST_SHOWN]}; mesh is needed"
        )
    positions = _positions(document, mesh, label)
    for controller in controllers:
        deformer, part_label = _deformer(controller), _label_of(controller)
        if tag(deformer) == "morph":
            positions = _morphed(document, deformer, positions, part_label)
        else:
            positions = _skinned(
                document,
                deformer,
                positions,
                _skeleton(document, scene_instance, world_matrices),
                part_label,
            )
            matrix = np.eye(4)
    bindings = _bindings(document, scene_instance)
    for number, primitive in enumerate(child for child in mesh if tag(child) not in _MESH_DATA):
        kind = tag(primitive)
        part_label = f"{label}, {kind} {number}"
        if kind not in _SURFACES:
            raise MeshError(f"{part_label} is not read; {', '.join(_SURFACES)} are")
        part = _Primitive(document, primitive, part_label).part(positions, bindings)
        if len(part.faces):
            yield from placed(part, matrix[None])


def _positions(document: ColladaDocument, mesh: Any, label: str) -> FloatArray:
    position = mesh.find("{*}vertices/{*}input[@semantic='POSITION']")
    if position is None:
        raise MeshError(f"{label} has no vertices with a POSITION")
    rows = document.rows(document.referred(position, "source", label, "source"))
    if rows.shape[1] != 3:
        raise MeshError(f"{label} has positions of {rows.shape[1]} numbers; 3 are needed")
    return rows


def _sources_by_semantic(document: ColladaDocument, holder: Any, label: str) -> dict[str, Any]:
    """Return the sources of a controller's inputs by their semantics."""
    return {
        element.get("semantic", ""): document.referred(element, "source", label, "source")
        for element in ([] if holder is None else holder.iterfind("{*}input"))
    }


def _required_sources(sources: dict[str, Any], names: Sequence[str], label: str) -> list[Any]:
    for name in names:
        if name not in sources:
            raise MeshError(f"{label} has no input {name}")
    return [sources[name] for name in names]


def _morphed(
    document: ColladaDocument, morph: Any, positions: FloatArray, label: str
) -> FloatArray:
    sources = _sources_by_semantic(document, morph.find("{*}targets"), label)
    targets, weights = _required_sources(sources, ("MORPH_TARGET", "MORPH_WEIGHT"), label)
    pairs = _paired(document.words(targets), document.rows(weights)[:, 0], "target", label)
    relative = morph.get("method", "NORMALIZED") == "RELATIVE"
    morphed = positions * (1.0 if relative else 1.0 - sum(weight for _, weight in pairs))
    for name, weight in pairs:
        if weight:
            target = document.named("geometry", name)
            mesh = None if target is None else target.find("{*}mesh")
            if mesh is None:
                raise MeshError(f"{label} has target {name[:_LONGEST_SHOWN]!r}, which is no mesh")
            target_positions = _positions(document, mesh, _label_of(target))
            if target_positions.shape != positions.shape:
                raise MeshError(
                    f"{label} has a target of {len(target_positions)} vertices; {len(positions)} are needed"
                )
            morphed = morphed + weight * target_positions
    return morphed


def _skeleton(
    document: ColladaDocument, scene_instance: _SceneInstance, world_matrices: dict[Any, FloatArray]
) -> dict[str, FloatArray]:
    """Return the matrices of possible joints of a skin by id, name and sid of the node."""
    # `skeleton` names the node below which joints are looked for (COLLADA 1.4.1, `instance_controller`). A node that no
    # scene shows stands where its own transforms and those of its ancestors put it.
    roots = [
        document.named("node", (element.text or "").strip().removeprefix("#"))
        for element in scene_instance.instance.iterfind("{*}skeleton")
    ]
    below = {node for root in roots if root is not None for node in root.iter("{*}node")}
    for root in roots:
        if root is not None and root not in world_matrices:
            _place_outside_scene(root, world_matrices)
    matrices: dict[str, FloatArray] = {}
    # Of equal names, the first node below the roots of the skeleton counts, else the first node.
    for is_below in (False, True):
        for key in ("name", "id", "sid"):
            matrices |= {
                node.get(key): matrix
                for node, matrix in reversed(world_matrices.items())
                if node.get(key) and (node in below) == is_below
            }
    return matrices


def _place_outside_scene(root: Any, world_matrices: dict[Any, FloatArray]) -> None:
    """Add the matrices of a node that the scene does not show, of its ancestors and of all nodes below."""
    for node in [*list(root.iterancestors("{*}node"))[::-1], *root.iter("{*}node")]:
        if node.find("{*}skew") is not None:
            raise MeshError(f"{_label_of_node(node)} has skew, which is not read")
        if node not in world_matrices:
            parent = world_matrices.get(node.getparent(), np.eye(4))
            world_matrices[node] = parent @ _local(node, _label_of_node(node))


def _paired(names: list[str], values: NDArray[Any], kind: str, label: str) -> list[tuple[str, Any]]:
    """Return pairs of a name and its values; raise `MeshError` if there are more of either."""
    if len(names) != len(values):
        raise MeshError(
            f"{label} has {len(values)} numbers or matrices for {len(names)} {kind}s; one each is needed"
        )
    return list(zip(names, values, strict=True))


def _skinned(
    document: ColladaDocument,
    skin: Any,
    positions: FloatArray,
    joints: dict[str, FloatArray],
    label: str,
) -> FloatArray:
    text = skin.findtext("{*}bind_shape_matrix")
    bind = np.eye(4) if text is None else _matrices(numbers(text, label), label)[0]
    positions = np.einsum("ij,vj->vi", bind[:3, :3], positions) + bind[:3, 3]
    of_joints = _sources_by_semantic(document, skin.find("{*}joints"), label)
    names, inverse = _required_sources(of_joints, ("JOINT", "INV_BIND_MATRIX"), label)
    inverses = _matrices(document.rows(inverse), f"INV_BIND_MATRIX of {label}")
    weights = skin.find("{*}vertex_weights")
    joint_source, weight_source = _required_sources(
        _sources_by_semantic(document, weights, label), ("JOINT", "WEIGHT"), label
    )
    matrices = dict(_paired(document.words(names), inverses, "joint", label))
    for name, inverse_bind in matrices.items():
        if name not in joints:
            raise MeshError(
                f"{label} follows joint {name[:_LONGEST_SHOWN]!r}, which is no node of the scene or of its skeleton; export it with its armature"
            )
        matrices[name] = joints[name] @ inverse_bind
    # Joint -1 means the bind shape itself.
    try:
        table = np.array([matrices[name] for name in document.words(joint_source)] + [np.eye(4)])
    except KeyError as error:
        raise MeshError(f"{label} weights joint {error}, which has no INV_BIND_MATRIX") from error
    rows, joint, weight = _influences(document, weights, weight_source, len(positions), label)
    return skinned(positions, rows, np.where(joint == -1, len(table) - 1, joint), weight, table)


def _matrices(values: FloatArray, label: str) -> FloatArray:
    """Return matrices (n, 4, 4), n at least 1; raise `MeshError` for another number of `values`."""
    if not values.size or values.size % 16:
        raise MeshError(f"{label} has a matrix of {values.size} numbers; 16 are needed")
    return values.reshape(-1, 4, 4)


def _influences(
    document: ColladaDocument, weights: Any, shares: Any, vertices: int, label: str
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return vertex, joint and weight of each influence, each of shape (n,)."""
    offsets = {
        element.get("semantic"): int(element.get("offset", 0))
        for element in weights.iterfind("{*}input")
    }
    counts = integers(weights.findtext("{*}vcount"), label)
    pairs = integers(weights.findtext("{*}v"), label)
    width = 1 + max(offsets.values())
    if counts.min(initial=0) < 0 or counts.sum() * width != len(pairs) or len(counts) > vertices:
        raise MeshError(
            f"{label} claims {counts.sum()} weights of {len(counts)} vertices; {len(pairs)} numbers "
            f"for {vertices} vertices are there"
        )
    pairs = pairs.reshape(-1, width)
    weight = _chosen(document.rows(shares), pairs[:, offsets["WEIGHT"]], label)[:, 0]
    return np.repeat(np.arange(len(counts)), counts), pairs[:, offsets["JOINT"]], weight


def _chosen(rows: FloatArray, index: IntArray, label: str) -> FloatArray:
    if index.size and (index.min() < 0 or index.max() >= len(rows)):
        raise MeshError(f"{label} names row {index.max()} of a source; {len(rows)} are there")
    return rows[index]


def _bindings(document: ColladaDocument, scene_instance: _SceneInstance) -> dict[str, _Binding]:
    bindings = {}
    for binding in scene_instance.instance.iterfind(
        "{*}bind_material/{*}technique_common/{*}instance_material"
    ):
        try:
            material = document.referred(binding, "material", scene_instance.label, "target")
        except MeshError as error:
            # The shape needs no material.
            document.companions.notes.append(f"has faces without their colours: {error}")
            continue
        sets = {
            vertex_input.get("semantic", ""): int(vertex_input.get("input_set", 0))
            for vertex_input in binding.iterfind("{*}bind_vertex_input")
        }
        bindings[binding.get("symbol", "")] = _Binding(material.get("id"), sets)
    return bindings


class _Primitive:
    """Triangles or polygons of a mesh, with the inputs of their corners."""

    def __init__(self, document: ColladaDocument, element: Any, label: str) -> None:
        self._document, self._element, self._label = document, element, label
        if element.find("{*}ph") is not None:
            raise MeshError(f"{label} has polygons with holes (ph), which are not read")
        self._columns = list(self._read_columns())
        width = 1 + max((column.offset for column in self._columns), default=0)
        rows = [integers(indices.text, label) for indices in element.iterfind("{*}p")]
        if any(len(row) % width for row in rows):
            raise MeshError(f"{label} has corners of {width} numbers each, and some are missing")
        self._lengths = np.array([len(row) // width for row in rows], dtype=np.int64)
        self._corners = np.concatenate([np.empty(0, np.int64), *rows]).reshape(-1, width)

    def _read_columns(self) -> Iterator[_Column]:
        for element in self._element.iterfind("{*}input"):
            offset, number = int(element.get("offset", 0)), int(element.get("set", 0))
            if element.get("semantic") != "VERTEX":
                source = self._document.referred(element, "source", self._label, "source")
                yield _Column(element.get("semantic", ""), source, offset, number)
                continue
            vertices = self._document.referred(element, "vertices", self._label, "source")
            yield _Column("VERTEX", None, offset, number)
            for vertex_input in vertices.iterfind("{*}input"):
                source = self._document.referred(vertex_input, "source", self._label, "source")
                yield _Column(
                    vertex_input.get("semantic", ""),
                    source,
                    offset,
                    int(vertex_input.get("set", 0)),
                )

    def part(self, positions: FloatArray, bindings: dict[str, _Binding]) -> Part:
        """Return the triangles with their colours or their image."""
        if not len(self._corners):
            return Part(positions, np.zeros((0, 3), dtype=np.int64))
        vertex = next((column for column in self._columns if column.semantic == "VERTEX"), None)
        if vertex is None:
            raise MeshError(f"{self._label} has no input VERTEX")
        corner_vertices = self._corners[:, vertex.offset]
        try:
            check_corners(corner_vertices, len(positions))
        except MeshError as error:
            raise MeshError(f"{self._label}: {error}") from error
        triangles = self._triangles(positions, corner_vertices)
        appearance, sets = self._appearance(bindings)
        paint = self._paint(appearance, sets, triangles)
        return Part(
            positions, corner_vertices[triangles], self._colours(appearance, triangles), paint
        )

    def _triangles(self, positions: FloatArray, corner_vertices: IntArray) -> IntArray:
        """Return triangles (t, 3) as rows of the corners."""
        kind, count = tag(self._element), len(corner_vertices)
        if kind == "triangles":
            if count % 3:
                raise MeshError(f"{self._label} has {count} corners, no multiple of 3")
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
            counts = integers(self._element.findtext("{*}vcount"), self._label)
        if counts.min(initial=0) < 0 or counts.sum() != count:
            raise MeshError(
                f"{self._label}: polygons claim {counts.sum()} corners, and {count} are there"
            )
        return triangulate(positions, corner_vertices, counts)[0]

    def _appearance(self, bindings: dict[str, _Binding]) -> tuple[Appearance, dict[str, int]]:
        symbol = self._element.get("material", "")
        if symbol in bindings:
            return self._document.appearance(bindings[symbol].material), bindings[symbol].sets
        # Some programs write the id of the material instead of a symbol.
        if self._document.named("material", symbol) is not None:
            return self._document.appearance(symbol), {}
        return Appearance(), {}

    def _paint(
        self, appearance: Appearance, sets: dict[str, int], triangles: IntArray
    ) -> Paint | None:
        if appearance.image is None:
            return None
        columns = {
            texcoords.number: texcoords
            for texcoords in self._columns
            if texcoords.semantic == "TEXCOORD"
        }
        if not columns:
            self._document.companions.notes.append(
                f"has an image on {self._label}, which has no TEXCOORD; the image is not read"
            )
            return None
        column = columns.get(sets.get(appearance.coordinates, -1), columns[min(columns)])
        rows = self._document.rows(column.source)
        if rows.shape[1] < 2:
            raise MeshError(f"{self._label} has image coordinates of {rows.shape[1]} numbers")
        corners = _chosen(rows, self._corners[:, column.offset], self._label)[:, :2]
        return Paint(appearance.image, corners[triangles], appearance.wraps)

    def _colours(self, appearance: Appearance, triangles: IntArray) -> NDArray[np.uint8] | None:
        """Return the mean colour of the corners, or the colour of the material if all corners are white."""
        columns = [column for column in self._columns if column.semantic == "COLOR"]
        if columns:
            column = min(columns, key=lambda column: column.number)
            rows = self._document.rows(column.source)[:, :3]
            corners = _chosen(rows, self._corners[:, column.offset], self._label)
            largest = 255.0 if corners.max(initial=0) > 1 else 1.0
            if corners.shape[1] == 3 and (corners != largest).any():
                stored = np.clip(np.nan_to_num(corners / largest), 0.0, 1.0)[triangles]
                return np.rint(255.0 * stored.mean(axis=1)).astype(np.uint8)
        if appearance.colour is None:
            return None
        colour = np.rint(255.0 * np.array(appearance.colour)).astype(np.uint8)
        return np.tile(colour, (len(triangles), 1))
