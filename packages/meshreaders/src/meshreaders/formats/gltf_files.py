"""Read the default scene of a glTF 2.0 file, text (.gltf) or binary (.glb), as parts.

Section numbers are those of the specification (ISO/IEC 12113:2022). Colours are linear in glTF and sRGB in parts. An
extension that is neither read nor harmless raises an error if the file requires the extension, or has no numbers
without it; otherwise the extension is noted. Unknown keys and attributes of nodes and primitives are noted.
Keys of materials other than the base colour, such as `alphaMode` and `normalTexture`, are ignored.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.base.rotations import rotation_matrices
from meshreaders.base.srgb import encode_bytes
from meshreaders.base.texture import CLAMP, MIRROR, REPEAT
from meshreaders.companions import Companions
from meshreaders.formats.gltf_document import (
    DRACO,
    PACKED_IMAGES,
    GltfDocument,
    not_read,
    required,
)
from meshreaders.formats.limits import check_parts
from meshreaders.formats.scenes import (
    fan_faces,
    placed,
    skinned,
    strip_faces,
)
from meshreaders.parts import Paint, Part
from meshreaders.polygons import check_corners
from meshreaders.textures import PackedImage

MOST_TINTS = 16
"""Largest number of tints that multiply an image of a primitive; with more tints, all faces have their mean.

A tint is the base colour times the mean vertex colour of a face. Tints are equal if they round to the same 8-bit sRGB.
"""

_INSTANCING, _VISIBILITY = "EXT_mesh_gpu_instancing", "KHR_node_visibility"
_GLOSSINESS, _TRANSFORM = "KHR_materials_pbrSpecularGlossiness", "KHR_texture_transform"
_IMAGE_EXTENSIONS = ("EXT_texture_avif", "EXT_texture_webp")
_NODE_KEYS = {
    "camera",
    "children",
    "matrix",
    "mesh",
    "rotation",
    "scale",
    "skin",
    "translation",
    "weights",
}
_PRIMITIVE_KEYS = {"attributes", "indices", "material", "mode", "targets"}
_ATTRIBUTE = re.compile(r"(POSITION|NORMAL|TANGENT|(TEXCOORD|COLOR|JOINTS|WEIGHTS)_\d+|_.*)")
_INSTANCE_ATTRIBUTE = re.compile(r"TRANSLATION|ROTATION|SCALE|_.*")
_NO_SURFACE = {0, 1, 2, 3}  # points and lines
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_BLOCK_FACES = 1 << 16
_WRAPS = {10497: REPEAT, 33071: CLAMP, 33648: MIRROR}


@dataclass(frozen=True)
class _MeshNode:
    """A node with a mesh: its index in `nodes`, its JSON, and the matrices (n, 4, 4) from mesh to scene per instance."""

    number: int
    entry: dict[str, Any]
    matrices: FloatArray


@dataclass(frozen=True)
class _Appearance:
    """Base colour (3,), linear, of a material, and the JSON that refers to its texture; `label` is for errors."""

    factor: FloatArray
    texture: dict[str, Any] | None
    label: str


def read_gltf(data: bytes, companions: Companions) -> list[Part]:
    """Read the meshes in the default scene of a glTF or GLB file, with the transforms of their nodes.

    Parts are in the file's frame, in metres, y up. Instances, skins and morph targets are applied. Hidden nodes are
    left out with all nodes below. Without a scene, all nodes are read. Colours are base colour times vertex colour,
    multiplied in linear light.

    Raises `MeshError` if the file is broken, has too many parts, or uses an unsupported feature. The message has only
    the reason; the caller adds the name of the file. Text that is no JSON raises `ValueError`.
    """
    companions.up_axis = "y"
    try:
        document = GltfDocument(data, companions)
        # Free the content of the file, which the document has divided into buffers.
        del data
        mesh_nodes = _mesh_nodes(document)
        _check_size(document, mesh_nodes)
        return [part for node in mesh_nodes for part in _mesh_parts(document, node)]
    except (AttributeError, KeyError, TypeError) as error:
        raise MeshError(
            f"its JSON has a value of a wrong type ({error}); check it with the glTF Validator"
        ) from error


def _mesh_nodes(document: GltfDocument) -> list[_MeshNode]:
    """Return the visible nodes with a mesh in the default scene, each parent before its children."""
    stack = [(number, np.eye(4)) for number in _roots(document)][::-1]
    mesh_nodes, visited = [], set()
    while stack:
        number, parent_matrix = stack.pop()
        if number in visited:
            raise MeshError(f"node {number} is twice in the scene; a tree is needed")
        visited.add(number)
        check_parts(len(visited), "nodes")
        node = document.entry("nodes", number, "the scene")
        label = f"node {number}"
        document.note_keys(node.keys() - _NODE_KEYS, label)
        document.note_extensions(node, label)
        extensions = node.get("extensions", {})
        if not extensions.get(_VISIBILITY, {}).get("visible", True):
            continue
        matrix = parent_matrix @ _local(node, label)
        if "mesh" in node:
            instances = _instances(document, extensions.get(_INSTANCING), label)
            mesh_nodes.append(_MeshNode(number, node, matrix @ instances))
        stack += [(child, matrix) for child in reversed(node.get("children", ()))]
    return mesh_nodes


def _roots(document: GltfDocument) -> Sequence[int]:
    """Return the root nodes (indices) of the default scene; without scenes, all nodes without a parent."""
    scenes, nodes = document.tree.get("scenes", ()), document.tree.get("nodes", ())
    if scenes:
        number = document.tree.get("scene", 0)
        if len(scenes) > 1:
            document.companions.notes.append(f"has {len(scenes)} scenes; scene {number} is read")
        scene = document.entry("scenes", number, "the file")
        document.note_extensions(scene, f"scene {number}")
        roots: list[int] = scene.get("nodes", [])
        return roots
    if not nodes and document.tree.get("meshes"):
        raise MeshError("it has meshes, and neither a scene nor a node that shows one")
    children = {child for node in nodes for child in node.get("children", ())}
    return [number for number in range(len(nodes)) if number not in children]


def _local(node: dict[str, Any], label: str) -> FloatArray:
    if "matrix" in node:
        return _vector(node, "matrix", np.eye(4).ravel(), label).reshape(4, 4).T
    return _placements(
        _vector(node, "translation", np.zeros(3), label)[None],
        _vector(node, "rotation", np.array([0.0, 0, 0, 1]), label)[None],
        _vector(node, "scale", np.ones(3), label)[None],
    )[0]


def _vector(holder: dict[str, Any], name: str, default: FloatArray, label: str) -> FloatArray:
    if name not in holder:
        return default
    numbers = np.array(holder[name], dtype=np.float64)
    if numbers.shape != default.shape:
        raise MeshError(f"{label} has {name} of {numbers.size} numbers; {default.size} are needed")
    return numbers


def _placements(shifts: FloatArray, quaternions: FloatArray, scales: FloatArray) -> FloatArray:
    """Return matrices (n, 4, 4) that scale, then rotate by quaternions (x, y, z, w), then shift."""
    matrices = np.tile(np.eye(4), (len(shifts), 1, 1))
    matrices[:, :3, :3] = rotation_matrices(quaternions) * scales[:, None, :]
    matrices[:, :3, 3] = shifts
    return matrices


def _instances(document: GltfDocument, extension: dict[str, Any] | None, label: str) -> FloatArray:
    """Return matrices (n, 4, 4) from mesh to node, one per instance; without the extension, one identity."""
    if extension is None:
        return np.eye(4)[None]
    attributes = required(extension, "attributes", dict, f"{_INSTANCING} of {label}")
    counts = {document.count(accessor, label) for accessor in attributes.values()}
    if len(counts) != 1:
        raise MeshError(f"{label} has instances whose attributes have {sorted(counts)} rows")
    (count,) = counts
    check_parts(0, "instances", count)
    columns = []
    for name, default in (
        ("TRANSLATION", np.zeros(3)),
        ("ROTATION", np.array([0.0, 0, 0, 1])),
        ("SCALE", np.ones(3)),
    ):
        rows = np.tile(default, (count, 1))
        if name in attributes:
            rows_label = f"{name} of the instances of {label}"
            rows = document.numbers(attributes[name], rows_label, len(default))
        columns.append(rows)
    document.note_keys(
        (name for name in attributes if not _INSTANCE_ATTRIBUTE.fullmatch(name)),
        f"instances of {label}",
    )
    return _placements(*columns)


def _check_size(document: GltfDocument, mesh_nodes: Sequence[_MeshNode]) -> None:
    """Raise `MeshError`, before data is read, for too many primitives of all nodes or corners of all instances."""
    parts, corners = 0, 0
    for mesh_node in mesh_nodes:
        mesh = document.entry("meshes", mesh_node.entry["mesh"], f"node {mesh_node.number}")
        primitives = required(mesh, "primitives", list, f"mesh {mesh_node.entry['mesh']}")
        parts += len(primitives)
        for primitive in primitives:
            attributes = required(
                primitive, "attributes", dict, f"a primitive of node {mesh_node.number}"
            )
            accessors = [attributes.get("POSITION"), primitive.get("indices")]
            counts = [
                document.count(index, "a primitive") for index in accessors if index is not None
            ]
            corners += len(mesh_node.matrices) * sum(counts)
        check_parts(parts, "primitives, each counted per node", corners)


def _mesh_parts(document: GltfDocument, mesh_node: _MeshNode) -> Iterator[Part]:
    number = mesh_node.entry["mesh"]
    mesh = document.entry("meshes", number, f"node {mesh_node.number}")
    document.note_extensions(mesh, f"mesh {number}")
    weights = mesh_node.entry.get("weights", mesh.get("weights", ()))
    for index, entry in enumerate(mesh["primitives"]):
        primitive = _Primitive(document, entry, weights, f"mesh {number}, primitive {index}")
        faces = primitive.faces()
        if len(faces):
            vertices, matrices = _posed(document, mesh_node, primitive)
            for part in primitive.painted(vertices, faces):
                yield from placed(part, matrices)


def _posed(
    document: GltfDocument, mesh_node: _MeshNode, primitive: _Primitive
) -> tuple[FloatArray, FloatArray]:
    """Return vertices (v, 3), and matrices (n, 4, 4) to the scene per instance: with a skin, one identity."""
    vertices, skin = primitive.positions(), mesh_node.entry.get("skin")
    if skin is None:
        return vertices, mesh_node.matrices
    if len(mesh_node.matrices) != 1:
        raise MeshError(f"node {mesh_node.number} has a skin and instances, which is not read")
    names = sorted(name for name in primitive.attributes if name.startswith("JOINTS_"))
    if not names:
        raise MeshError(
            f"node {mesh_node.number} has a skin, and {primitive.label} has no JOINTS_0"
        )
    joints = np.hstack([primitive.stored(name, 4).astype(np.int64) for name in names])
    weights = np.hstack(
        [primitive.fractions(name.replace("JOINTS", "WEIGHTS"), 4) for name in names]
    )
    matrices = _joint_matrices(document, skin, f"node {mesh_node.number}")
    # The transform of a node with a skin is ignored (section 3.7.3.3).
    rows = np.repeat(np.arange(len(vertices)), joints.shape[1])
    vertices = skinned(vertices, rows, joints.ravel(), weights.ravel(), matrices)
    return vertices, np.eye(4)[None]


def _joint_matrices(document: GltfDocument, skin: Any, label: str) -> FloatArray:
    """Return matrices (j, 4, 4) per joint from the mesh at rest to the scene: joint to scene times inverse bind."""
    entry = document.entry("skins", skin, label)
    document.note_extensions(entry, f"skin {skin}")
    joints, parents = required(entry, "joints", list, f"skin {skin}"), _parents(document)
    worlds = np.array([_world(document, joint, parents) for joint in joints])
    if "inverseBindMatrices" not in entry:
        return worlds
    matrices_label = f"inverseBindMatrices of skin {skin}"
    inverses = document.numbers(entry["inverseBindMatrices"], matrices_label, 16)
    if len(inverses) < len(worlds):
        raise MeshError(f"skin {skin} has {len(worlds)} joints and {len(inverses)} matrices")
    return worlds @ inverses[: len(worlds)].reshape(-1, 4, 4).transpose(0, 2, 1)


def _parents(document: GltfDocument) -> dict[int, int]:
    return {
        child: number
        for number, node in enumerate(document.tree.get("nodes", ()))
        for child in node.get("children", ())
    }


def _world(document: GltfDocument, joint: int, parents: dict[int, int]) -> FloatArray:
    """Return the matrix (4, 4) from a joint's frame to the scene, computed once per node of the document."""
    document.entry("nodes", joint, "a skin")
    path: list[int] = []
    above: int | None = joint
    while above is not None and above not in document.worlds:
        path.append(above)
        if len(path) > len(parents) + 1:
            raise MeshError(f"node {joint} is below itself; a tree is needed")
        above = parents.get(above)
    matrix = np.eye(4) if above is None else document.worlds[above]
    for number in reversed(path):
        matrix = matrix @ _local(document.entry("nodes", number, "a skin"), f"node {number}")
        document.worlds[number] = matrix
    return matrix


class _Primitive:
    """A primitive of a mesh: its triangles, vertices and colours. `entry` is its JSON, `weights` those of morph targets."""

    def __init__(
        self,
        document: GltfDocument,
        entry: dict[str, Any],
        weights: Sequence[float],
        label: str,
    ) -> None:
        document.note_keys(entry.keys() - _PRIMITIVE_KEYS, label)
        document.note_extensions(entry, label)
        self.document, self.entry, self.label = document, entry, label
        self.attributes: dict[str, int] = entry["attributes"]
        document.note_keys(
            (name for name in self.attributes if not _ATTRIBUTE.fullmatch(name)), label
        )
        self._check_plain_numbers()
        targets = entry.get("targets", [])
        if any(weights) and len(weights) != len(targets):
            raise MeshError(f"{label} has {len(targets)} morph targets and {len(weights)} weights")
        pairs = zip(targets, weights, strict=False)
        self._targets = [(target, weight) for target, weight in pairs if weight]

    def _check_plain_numbers(self) -> None:
        """Raise `MeshError` if positions or indices are only in compressed form."""
        if DRACO not in self.entry.get("extensions", {}):
            return
        for accessor in (self.attributes.get("POSITION"), self.entry.get("indices")):
            if accessor is None:
                continue
            described = self.document.entry("accessors", accessor, self.label)
            if "bufferView" not in described and "sparse" not in described:
                raise MeshError(not_read(self.label, DRACO))

    def faces(self) -> IntArray:
        """Return vertex indices (f, 3) of the triangles; (0, 3) for points and lines, or without vertices."""
        mode = self.entry.get("mode", _TRIANGLES)
        if mode in _NO_SURFACE or "POSITION" not in self.attributes:
            return np.zeros((0, 3), dtype=np.int64)
        corners = self._corners()
        if mode == _TRIANGLES:
            if len(corners) % 3:
                raise MeshError(f"{self.label} has {len(corners)} corners, no multiple of 3")
            return corners.reshape(-1, 3)
        if mode not in {_STRIP, _FAN}:
            raise MeshError(f"{self.label} is of mode {str(mode)[:9]}; 0 to 6 are allowed")
        if len(corners) < 3:
            return np.zeros((0, 3), dtype=np.int64)
        corners = corners.astype(np.int64)
        return strip_faces(corners) if mode == _STRIP else fan_faces(corners)

    def _corners(self) -> IntArray:
        """Return the vertex index per corner, (n,); without `indices`, every vertex in its order."""
        count = self.document.count(self.attributes["POSITION"], self.label)
        if "indices" not in self.entry:
            return np.arange(count)
        stored = self.document.stored(self.entry["indices"], f"indices of {self.label}", 1)
        if stored.dtype.kind != "u":
            raise MeshError(f"{self.label} has indices of {stored.dtype}; unsigned ones are needed")
        corners = stored[:, 0]
        try:
            check_corners(corners, count)
        except MeshError as error:
            raise MeshError(f"{self.label}: {error}") from error
        return corners

    def positions(self) -> FloatArray:
        """Return vertices (v, 3) in the frame of the mesh, with the morph targets applied."""
        return self._morphed("POSITION", self.numbers("POSITION", 3))

    def numbers(self, name: str, *widths: int) -> FloatArray:
        """Return an attribute (v, k), float64; integers become fractions only if marked `normalized`. `widths`: allowed k."""
        return self._checked_rows(
            name, self.document.numbers(self._accessor(name), self._label_of(name), *widths)
        )

    def fractions(self, name: str, *widths: int) -> FloatArray:
        """Return an attribute (v, k), float64; integers always become fractions of the largest integer of their type."""
        return self._checked_rows(
            name, self.document.fractions(self._accessor(name), self._label_of(name), *widths)
        )

    def stored(self, name: str, *widths: int) -> NDArray[Any]:
        """Return an attribute (v, k) in its stored type; k must be in `widths`."""
        return self._checked_rows(
            name, self.document.stored(self._accessor(name), self._label_of(name), *widths)
        )

    def painted(self, vertices: FloatArray, faces: IntArray) -> Iterator[Part]:
        """Yield one part with face colours, or one part per tint of the image; vertices are not transformed."""
        appearance = _appearance(self.document, self.entry, self.label)
        image = None if appearance.texture is None else self._image(appearance)
        if image is None:
            encoded = np.concatenate(
                [encode_bytes(block) for block in self._linear_colours(appearance, faces)]
            )
            yield Part(vertices, faces, np.broadcast_to(encoded, (len(faces), 3)))
            return
        colours = np.concatenate(list(self._linear_colours(appearance, faces)))
        coordinates, wraps = self._coordinates(appearance), self._wraps(appearance)
        for tinted_faces, tint in self._tints(colours, len(faces)):
            red, green, blue = map(float, tint)
            paint = Paint(
                image, coordinates[faces[tinted_faces]], wraps, (red, green, blue), linear=True
            )
            yield Part(vertices, faces[tinted_faces], None, paint)

    def _linear_colours(self, appearance: _Appearance, faces: IntArray) -> Iterator[FloatArray]:
        """Yield linear colours (n, 3) per block of faces; without vertex colours, only the base colour (1, 3)."""
        if "COLOR_0" not in self.attributes:
            yield np.clip(appearance.factor[None], 0.0, 1.0)
            return
        corners = self._morphed("COLOR_0", self.fractions("COLOR_0", 3, 4))[:, :3]
        corners = np.nan_to_num(corners)
        for start in range(0, len(faces), _BLOCK_FACES):
            mean = corners[faces[start : start + _BLOCK_FACES]].mean(axis=1)
            yield np.clip(appearance.factor * mean, 0.0, 1.0)

    def _tints(self, colours: FloatArray, face_count: int) -> Iterator[tuple[Any, FloatArray]]:
        """Yield the faces of each tint, as index array or slice, and the tint (3,), linear; see `MOST_TINTS`."""
        tones, group = np.unique(encode_bytes(colours), axis=0, return_inverse=True)
        if len(tones) == 1:
            yield slice(None), colours.mean(axis=0)
        elif len(tones) > MOST_TINTS:
            self.document.companions.notes.append(
                f"has {len(tones)} vertex colours on an image ({self.label}); their mean is read"
            )
            yield slice(None), colours.mean(axis=0)
        else:
            for number in range(len(tones)):
                tinted_faces = np.flatnonzero(group.reshape(face_count) == number)
                yield tinted_faces, colours[tinted_faces].mean(axis=0)

    def _image(self, appearance: _Appearance) -> PackedImage | None:
        """Return the image of a material; None if none can be used, in most cases with a remark in `companions`."""
        info = appearance.texture or {}
        self.document.note_extensions(info, f"the image of {appearance.label}")
        if self._texcoord(appearance) not in self.attributes:
            self.document.companions.notes.append(
                f"has an image on {self.label}, which has no {self._texcoord(appearance)}; the image is not read"
            )
            return None
        texture = self.document.entry("textures", info.get("index"), appearance.label)
        label = f"texture {info.get('index')}"
        self.document.note_extensions(texture, label)
        extensions = texture.get("extensions", {})
        sources = [
            extensions[name].get("source") for name in _IMAGE_EXTENSIONS if name in extensions
        ]
        for source in [*sources, texture.get("source")]:
            image = None if source is None else self.document.image(source, label)
            if image is not None:
                return image
        for name in extensions:
            if name in PACKED_IMAGES and "source" not in texture:
                clause = f"{label} by the extension {name}, which is not read; save its image as PNG or JPEG"
                if clause not in self.document.companions.missing:
                    self.document.companions.missing.append(clause)
        return None

    def _texcoord(self, appearance: _Appearance) -> str:
        """Return the name of the attribute with the image coordinates, such as TEXCOORD_0."""
        info = appearance.texture or {}
        extension = info.get("extensions", {}).get(_TRANSFORM, {})
        return f"TEXCOORD_{extension.get('texCoord', info.get('texCoord', 0))}"

    def _coordinates(self, appearance: _Appearance) -> FloatArray:
        """Return image coordinates (v, 2): 0 to 1 is one image, right and, unlike in glTF, up."""
        name = self._texcoord(appearance)
        stored = self._morphed(name, self.numbers(name, 2))
        extension = (appearance.texture or {}).get("extensions", {}).get(_TRANSFORM, {})
        across, down = (stored * _vector(extension, "scale", np.ones(2), appearance.label)).T
        # The rotation is counter-clockwise in coordinates whose v points down.
        angle = extension.get("rotation", 0.0)
        cosine, sine = np.cos(angle), np.sin(angle)
        rotated = np.column_stack([cosine * across + sine * down, cosine * down - sine * across])
        shifted = rotated + _vector(extension, "offset", np.zeros(2), appearance.label)
        return np.column_stack([shifted[:, 0], 1.0 - shifted[:, 1]])

    def _wraps(self, appearance: _Appearance) -> tuple[int, int]:
        """Return REPEAT, CLAMP or MIRROR along the image's width and height."""
        texture = self.document.entry(
            "textures", (appearance.texture or {}).get("index"), appearance.label
        )
        if "sampler" not in texture:
            return REPEAT, REPEAT
        sampler = self.document.entry("samplers", texture["sampler"], appearance.label)
        self.document.note_extensions(sampler, f"sampler {texture['sampler']}")
        across, up = (_WRAPS.get(sampler.get(name, 0), REPEAT) for name in ("wrapS", "wrapT"))
        return across, up

    def _morphed(self, name: str, values: FloatArray) -> FloatArray:
        """Return the values (v, k) of an attribute plus the weighted offsets of the morph targets."""
        for target, weight in self._targets:
            if name in target:
                target_label = f"the morph target's {name} of {self.label}"
                offsets = self.document.numbers(target[name], target_label, values.shape[1])
                values = values + weight * self._checked_rows(name, offsets)
        return values

    def _accessor(self, name: str) -> int:
        if name not in self.attributes:
            raise MeshError(f"{self.label} has no {name}")
        return self.attributes[name]

    def _label_of(self, name: str) -> str:
        return f"{name} of {self.label}"

    def _checked_rows(self, name: str, rows: NDArray[Any]) -> NDArray[Any]:
        count = self.document.count(self.attributes["POSITION"], self.label)
        if len(rows) != count:
            raise MeshError(f"{self.label} has {len(rows)} rows of {name}; {count} are needed")
        return rows


def _appearance(document: GltfDocument, primitive: dict[str, Any], label: str) -> _Appearance:
    """Return base colour, without alpha, and texture of a primitive; white without a material (section 3.7.2.1)."""
    if "material" not in primitive:
        return _Appearance(np.ones(3), None, label)
    number = primitive["material"]
    label = f"material {number}"
    material = document.entry("materials", number, label)
    document.note_extensions(material, label)
    shading = material.get("extensions", {}).get(_GLOSSINESS)
    names = ("diffuseFactor", "diffuseTexture")
    if shading is None:
        names = ("baseColorFactor", "baseColorTexture")
        shading = material.get("pbrMetallicRoughness", {})
    factor_key, texture_key = names
    colour = _vector(shading, factor_key, np.ones(4), label)[:3]
    return _Appearance(np.nan_to_num(colour), shading.get(texture_key), label)
