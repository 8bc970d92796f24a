"""glTF 2.0 files, as text (.gltf) or binary (.glb): what their scene shows, as parts.

Section numbers of comments are those of the specification (ISO/IEC 12113:2022). Colours are light in
glTF and stored as sRGB here. A node, primitive, material or texture in use that carries what is not
read is refused by its name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.srgb import encode_bytes
from visuohaptic.geometry.texture import CLAMP, MIRROR, REPEAT
from visuohaptic.geometry.turning import rotation_matrices
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.gltf_document import (
    GltfDocument,
    refuse_other_keys,
    refuse_unknown,
    required,
)
from visuohaptic.meshes.limits import check_parts
from visuohaptic.meshes.parts import Paint, Part
from visuohaptic.meshes.polygons import check_corners
from visuohaptic.meshes.scenes import (
    fan_faces,
    placed,
    skinned,
    strip_faces,
)

MOST_TINTS = 16
"""Vertex colours that multiply one image on one primitive; of more, their mean does."""

_INSTANCING, _VISIBILITY = "EXT_mesh_gpu_instancing", "KHR_node_visibility"
_GLOSSINESS, _TRANSFORM = "KHR_materials_pbrSpecularGlossiness", "KHR_texture_transform"
_DRACO = "KHR_draco_mesh_compression"
_IMAGE_EXTENSIONS = ("EXT_texture_avif", "EXT_texture_webp")
_PACKED_IMAGES = ("KHR_texture_basisu", "MSFT_texture_dds")
_NODE_KEYS = (
    "camera",
    "children",
    "matrix",
    "mesh",
    "rotation",
    "scale",
    "skin",
    "translation",
    "weights",
)
_PRIMITIVE_KEYS = ("attributes", "indices", "material", "mode", "targets")
_ATTRIBUTE = re.compile(r"(POSITION|NORMAL|TANGENT|(TEXCOORD|COLOR|JOINTS|WEIGHTS)_\d+|_.*)")
_NO_SURFACE = {0, 1, 2, 3}  # points and lines
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_AT_ONCE = 1 << 16  # faces
_WRAPS = {10497: REPEAT, 33071: CLAMP, 33648: MIRROR}


@dataclass(frozen=True)
class _Shown:
    """A node that shows a mesh: its number, its entry, and the matrices (n, 4, 4) of its instances."""

    number: int
    node: dict[str, Any]
    matrices: FloatArray


@dataclass(frozen=True)
class _Look:
    """The base colour of a primitive's material, as light, and what it says of its image."""

    factor: FloatArray
    texture: dict[str, Any] | None
    place: str


def read_gltf(data: bytes, companions: Companions) -> list[Part]:
    """Read what the default scene of a glTF or GLB file shows, each mesh where its nodes put it.

    Parts are in the file's frame, in metres: instances, skins at their pose and morph targets at their
    weights are applied. Colours are base colour times vertex colours, multiplied as light. Raises
    `MeshError`, with the reason only, if the file is broken, shows too much, or uses what is not read.
    """
    companions.up_axis = "y"
    document = GltfDocument(data, companions)
    # The file's text is not needed beside its buffers.
    del data
    shown = _shown(document)
    _check_size(document, shown)
    return [part for one in shown for part in _mesh_parts(document, one)]


def _shown(document: GltfDocument) -> list[_Shown]:
    """Return the nodes of the default scene that show a mesh, in the order of the tree."""
    waiting = [(number, np.eye(4)) for number in _roots(document)][::-1]
    shown, visited = [], set()
    while waiting:
        number, above = waiting.pop()
        if number in visited:
            raise MeshError(f"node {number} stands twice in the scene; a tree is needed")
        visited.add(number)
        check_parts(len(visited), "nodes")
        node = document.entry("nodes", number, "the scene")
        place = f"node {number}"
        refuse_other_keys(node, place, _NODE_KEYS)
        refuse_unknown(node, place, (_INSTANCING, _VISIBILITY))
        extensions = node.get("extensions", {})
        if not extensions.get(_VISIBILITY, {}).get("visible", True):
            continue
        world = above @ _local(node, place)
        if "mesh" in node:
            instances = _instances(document, extensions.get(_INSTANCING), place)
            shown.append(_Shown(number, node, world @ instances))
        waiting += [(child, world) for child in reversed(node.get("children", ()))]
    return shown


def _roots(document: GltfDocument) -> Sequence[int]:
    scenes, nodes = document.tree.get("scenes", ()), document.tree.get("nodes", ())
    if scenes:
        number = document.tree.get("scene", 0)
        if len(scenes) > 1:
            document.companions.notes.append(
                f"has {len(scenes)} scenes, of which number {number} is read"
            )
        scene = document.entry("scenes", number, "the file")
        refuse_unknown(scene, f"scene {number}", ())
        roots: list[int] = scene.get("nodes", [])
        return roots
    if not nodes and document.tree.get("meshes"):
        raise MeshError("it has meshes, and neither a scene nor a node that shows one")
    children = {child for node in nodes for child in node.get("children", ())}
    return [number for number in range(len(nodes)) if number not in children]


def _local(node: dict[str, Any], place: str) -> FloatArray:
    if "matrix" in node:
        return _vector(node, "matrix", np.eye(4).ravel(), place).reshape(4, 4).T
    return _placements(
        _vector(node, "translation", np.zeros(3), place)[None],
        _vector(node, "rotation", np.array([0.0, 0, 0, 1]), place)[None],
        _vector(node, "scale", np.ones(3), place)[None],
    )[0]


def _vector(holder: dict[str, Any], name: str, default: FloatArray, place: str) -> FloatArray:
    if name not in holder:
        return default
    numbers = np.array(holder[name], dtype=np.float64)
    if numbers.shape != default.shape:
        raise MeshError(f"{place} has {name} of {numbers.size} numbers; {default.size} are needed")
    return numbers


def _placements(shifts: FloatArray, quaternions: FloatArray, scales: FloatArray) -> FloatArray:
    matrices = np.tile(np.eye(4), (len(shifts), 1, 1))
    matrices[:, :3, :3] = rotation_matrices(quaternions) * scales[:, None, :]
    matrices[:, :3, 3] = shifts
    return matrices


def _instances(document: GltfDocument, extension: dict[str, Any] | None, place: str) -> FloatArray:
    """Return the matrices (n, 4, 4) of a node's instances; without the extension the unit matrix."""
    if extension is None:
        return np.eye(4)[None]
    attributes = required(extension, "attributes", dict, f"{_INSTANCING} of {place}")
    counts = {document.count(one, place) for one in attributes.values()}
    if len(counts) != 1:
        raise MeshError(f"{place} has instances whose attributes have {sorted(counts)} rows")
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
            what = f"{name} of the instances of {place}"
            rows = document.numbers(attributes[name], what, len(default))
        columns.append(rows)
    for name in attributes:
        if name not in {"TRANSLATION", "ROTATION", "SCALE"} and not name.startswith("_"):
            raise MeshError(f"the instances of {place} have {name[:80]!r}, which is not read")
    return _placements(*columns)


def _check_size(document: GltfDocument, shown: Sequence[_Shown]) -> None:
    """Refuse too many primitives or corners, each counted wherever it stands, before any is read."""
    parts, corners = 0, 0
    for one in shown:
        mesh = document.entry("meshes", one.node["mesh"], f"node {one.number}")
        primitives = required(mesh, "primitives", list, f"mesh {one.node['mesh']}")
        parts += len(primitives)
        for primitive in primitives:
            attributes = required(
                primitive, "attributes", dict, f"a primitive of node {one.number}"
            )
            read = [attributes.get("POSITION"), primitive.get("indices")]
            counts = [document.count(one, "a primitive") for one in read if one is not None]
            corners += len(one.matrices) * sum(counts)
        check_parts(parts, "primitives, counted wherever one stands", corners)


def _mesh_parts(document: GltfDocument, shown: _Shown) -> Iterator[Part]:
    number = shown.node["mesh"]
    mesh = document.entry("meshes", number, f"node {shown.number}")
    refuse_unknown(mesh, f"mesh {number}", ())
    weights = shown.node.get("weights", mesh.get("weights", ()))
    for place, primitive in enumerate(mesh["primitives"]):
        one = _Primitive(document, primitive, weights, f"mesh {number}, primitive {place}")
        faces = one.faces()
        if len(faces):
            vertices, matrices = _posed(document, shown, one)
            for part in one.painted(vertices, faces):
                yield from placed(part, matrices)


def _posed(document: GltfDocument, shown: _Shown, one: _Primitive) -> tuple[FloatArray, FloatArray]:
    """Return the vertices of a primitive, and the matrices that place them; a skin places them itself."""
    vertices, skin = one.positions(), shown.node.get("skin")
    if skin is None:
        return vertices, shown.matrices
    if len(shown.matrices) != 1:
        raise MeshError(f"node {shown.number} has a skin and instances, which is not read")
    names = sorted(name for name in one.attributes if name.startswith("JOINTS_"))
    if not names:
        raise MeshError(f"node {shown.number} has a skin, and {one.place} has no JOINTS_0")
    joints = np.hstack([one.stored(name, 4).astype(np.int64) for name in names])
    weights = np.hstack([one.shares(name.replace("JOINTS", "WEIGHTS"), 4) for name in names])
    matrices = _joint_matrices(document, skin, f"node {shown.number}")
    # The node's own place does not count (section 3.7.3.3).
    rows = np.repeat(np.arange(len(vertices)), joints.shape[1])
    vertices = skinned(vertices, rows, joints.ravel(), weights.ravel(), matrices)
    return vertices, np.eye(4)[None]


def _joint_matrices(document: GltfDocument, skin: Any, place: str) -> FloatArray:
    described = document.entry("skins", skin, place)
    refuse_unknown(described, f"skin {skin}", ())
    joints, above = required(described, "joints", list, f"skin {skin}"), _parents(document)
    worlds = np.array([_world(document, joint, above) for joint in joints])
    if "inverseBindMatrices" not in described:
        return worlds
    what = f"inverseBindMatrices of skin {skin}"
    bound = document.numbers(described["inverseBindMatrices"], what, 16)
    if len(bound) < len(worlds):
        raise MeshError(f"skin {skin} has {len(worlds)} joints and {len(bound)} matrices")
    return worlds @ bound[: len(worlds)].reshape(-1, 4, 4).transpose(0, 2, 1)


def _parents(document: GltfDocument) -> dict[int, int]:
    return {
        child: number
        for number, node in enumerate(document.tree.get("nodes", ()))
        for child in node.get("children", ())
    }


def _world(document: GltfDocument, joint: int, above: dict[int, int]) -> FloatArray:
    matrix, number, steps = np.eye(4), joint, 0
    while True:
        node = document.entry("nodes", number, "a skin")
        matrix = _local(node, f"node {number}") @ matrix
        if number not in above:
            return matrix
        number, steps = above[number], steps + 1
        if steps > len(above):
            raise MeshError(f"node {joint} is below itself; a tree is needed")


class _Primitive:
    """A primitive of a mesh: its triangles, vertices and colours."""

    def __init__(
        self,
        document: GltfDocument,
        described: dict[str, Any],
        weights: Sequence[float],
        place: str,
    ) -> None:
        refuse_other_keys(described, place, _PRIMITIVE_KEYS)
        refuse_unknown(described, place, ())
        self.document, self.described, self.place = document, described, place
        self.attributes: dict[str, int] = described["attributes"]
        for name in self.attributes:
            if not _ATTRIBUTE.fullmatch(name):
                raise MeshError(f"{place} has the attribute {name[:80]!r}, which is not read")
        targets = described.get("targets", [])
        if any(weights) and len(weights) != len(targets):
            raise MeshError(f"{place} has {len(targets)} morph targets and {len(weights)} weights")
        pairs = zip(targets, weights, strict=False)
        self._targets = [(target, weight) for target, weight in pairs if weight]

    def faces(self) -> IntArray:
        """Return triangles (f, 3); none of points and lines."""
        mode = self.described.get("mode", _TRIANGLES)
        if mode in _NO_SURFACE or "POSITION" not in self.attributes:
            return np.zeros((0, 3), dtype=np.int64)
        corners = self._corners()
        if mode == _TRIANGLES:
            if len(corners) % 3:
                raise MeshError(f"{self.place} has {len(corners)} corners, no multiple of 3")
            return corners.reshape(-1, 3)
        if mode not in {_STRIP, _FAN}:
            raise MeshError(f"{self.place} is of mode {str(mode)[:9]}; 0 to 6 are allowed")
        if len(corners) < 3:
            return np.zeros((0, 3), dtype=np.int64)
        corners = corners.astype(np.int64)
        return strip_faces(corners) if mode == _STRIP else fan_faces(corners)

    def _corners(self) -> IntArray:
        count = self.document.count(self.attributes["POSITION"], self.place)
        if "indices" not in self.described:
            return np.arange(count)
        stored = self.document.stored(self.described["indices"], f"indices of {self.place}", 1)
        if stored.dtype.kind != "u":
            raise MeshError(f"{self.place} has indices of {stored.dtype}; unsigned ones are needed")
        corners = stored[:, 0]
        try:
            check_corners(corners, count)
        except MeshError as error:
            raise MeshError(f"{self.place}: {error}") from error
        return corners

    def positions(self) -> FloatArray:
        """Return vertices (v, 3), the morph targets applied."""
        position = self.document.entry("accessors", self.attributes["POSITION"], self.place)
        if _DRACO in self.described.get("extensions", {}) and "bufferView" not in position:
            raise MeshError(f"{self.place} has the extension {_DRACO}, which is not read")
        return self._morphed("POSITION", self.numbers("POSITION", 3))

    def numbers(self, name: str, *widths: int) -> FloatArray:
        """Return an attribute, (v, k)."""
        return self._whole(
            name, self.document.numbers(self._accessor(name), self._what(name), *widths)
        )

    def shares(self, name: str, *widths: int) -> FloatArray:
        """Return an attribute, (v, k), whose integers stand for shares of their largest."""
        return self._whole(
            name, self.document.shares(self._accessor(name), self._what(name), *widths)
        )

    def stored(self, name: str, *widths: int) -> NDArray[Any]:
        """Return an attribute, (v, k), as it is stored."""
        return self._whole(
            name, self.document.stored(self._accessor(name), self._what(name), *widths)
        )

    def painted(self, vertices: FloatArray, faces: IntArray) -> Iterator[Part]:
        """Return the triangles as parts of one colour or image each."""
        look = _look(self.document, self.described, self.place)
        image = None if look.texture is None else self._image(look)
        if image is None:
            encoded = np.concatenate([encode_bytes(light) for light in self._light(look, faces)])
            yield Part(vertices, faces, np.broadcast_to(encoded, (len(faces), 3)))
            return
        light = np.concatenate(list(self._light(look, faces)))
        coordinates, wraps = self._coordinates(look), self._wraps(look)
        for chosen, tint in self._tints(light, len(faces)):
            red, green, blue = map(float, tint)
            paint = Paint(image, coordinates[faces[chosen]], wraps, (red, green, blue), linear=True)
            yield Part(vertices, faces[chosen], None, paint)

    def _light(self, look: _Look, faces: IntArray) -> Iterator[FloatArray]:
        """Yield the light of faces, (n, 3), in blocks; one row where no vertex has a colour."""
        if "COLOR_0" not in self.attributes:
            yield np.clip(look.factor[None], 0.0, 1.0)
            return
        corners = self._morphed("COLOR_0", self.shares("COLOR_0", 3, 4))[:, :3]
        corners = np.nan_to_num(corners)
        for start in range(0, len(faces), _AT_ONCE):
            mean = corners[faces[start : start + _AT_ONCE]].mean(axis=1)
            yield np.clip(look.factor * mean, 0.0, 1.0)

    def _tints(self, light: FloatArray, count: int) -> Iterator[tuple[Any, FloatArray]]:
        """Return the faces that share a colour which multiplies their image."""
        tones, group = np.unique(encode_bytes(light), axis=0, return_inverse=True)
        if len(tones) == 1:
            yield slice(None), light.mean(axis=0)
        elif len(tones) > MOST_TINTS:
            self.document.companions.notes.append(
                f"has {len(tones)} vertex colours upon an image ({self.place}), of which the mean is read"
            )
            yield slice(None), light.mean(axis=0)
        else:
            for number in range(len(tones)):
                chosen = np.flatnonzero(group.reshape(count) == number)
                yield chosen, light[chosen].mean(axis=0)

    def _image(self, look: _Look) -> Any:
        info = look.texture or {}
        refuse_unknown(info, f"the image of {look.place}", (_TRANSFORM,))
        if self._texcoord(look) not in self.attributes:
            self.document.companions.notes.append(
                f"has an image on {self.place}, which has no {self._texcoord(look)}; the image is not read"
            )
            return None
        texture = self.document.entry("textures", info.get("index"), look.place)
        place = f"texture {info.get('index')}"
        refuse_unknown(texture, place, _IMAGE_EXTENSIONS)
        extensions = texture.get("extensions", {})
        sources = [
            extensions[name].get("source") for name in _IMAGE_EXTENSIONS if name in extensions
        ]
        for source in [*sources, texture.get("source")]:
            image = None if source is None else self.document.image(source, place)
            if image is not None:
                return image
        for name in extensions:
            if name in _PACKED_IMAGES and "source" not in texture:
                clause = f"{place} by the extension {name}, which is not read"
                if clause not in self.document.companions.missing:
                    self.document.companions.missing.append(clause)
        return None

    def _texcoord(self, look: _Look) -> str:
        info = look.texture or {}
        extension = info.get("extensions", {}).get(_TRANSFORM, {})
        return f"TEXCOORD_{extension.get('texCoord', info.get('texCoord', 0))}"

    def _coordinates(self, look: _Look) -> FloatArray:
        """Return the coordinates (v, 2) in the image, v upwards."""
        name = self._texcoord(look)
        stored = self._morphed(name, self.numbers(name, 2))
        extension = (look.texture or {}).get("extensions", {}).get(_TRANSFORM, {})
        across, down = (stored * _vector(extension, "scale", np.ones(2), look.place)).T
        # Counter-clockwise where v points downwards.
        angle = extension.get("rotation", 0.0)
        cosine, sine = np.cos(angle), np.sin(angle)
        turned = np.column_stack([cosine * across + sine * down, cosine * down - sine * across])
        moved = turned + _vector(extension, "offset", np.zeros(2), look.place)
        return np.column_stack([moved[:, 0], 1.0 - moved[:, 1]])

    def _wraps(self, look: _Look) -> tuple[int, int]:
        texture = self.document.entry("textures", (look.texture or {}).get("index"), look.place)
        if "sampler" not in texture:
            return REPEAT, REPEAT
        sampler = self.document.entry("samplers", texture["sampler"], look.place)
        refuse_unknown(sampler, f"sampler {texture['sampler']}", ())
        across, up = (_WRAPS.get(sampler.get(name, 0), REPEAT) for name in ("wrapS", "wrapT"))
        return across, up

    def _morphed(self, name: str, values: FloatArray) -> FloatArray:
        for target, weight in self._targets:
            if name in target:
                what = f"the morph target's {name} of {self.place}"
                moved = self.document.numbers(target[name], what, values.shape[1])
                values = values + weight * self._whole(name, moved)
        return values

    def _accessor(self, name: str) -> int:
        if name not in self.attributes:
            raise MeshError(f"{self.place} has no {name}")
        return self.attributes[name]

    def _what(self, name: str) -> str:
        return f"{name} of {self.place}"

    def _whole(self, name: str, rows: NDArray[Any]) -> NDArray[Any]:
        count = self.document.count(self.attributes["POSITION"], self.place)
        if len(rows) != count:
            raise MeshError(f"{self.place} has {len(rows)} rows of {name}; {count} are needed")
        return rows


def _look(document: GltfDocument, primitive: dict[str, Any], place: str) -> _Look:
    """Return the base colour and image of a primitive; without a material white (section 3.7.2.1)."""
    if "material" not in primitive:
        return _Look(np.ones(3), None, place)
    number = primitive["material"]
    place = f"material {number}"
    material = document.entry("materials", number, place)
    refuse_unknown(material, place, (_GLOSSINESS,))
    glossy = material.get("extensions", {}).get(_GLOSSINESS)
    names = ("diffuseFactor", "diffuseTexture")
    if glossy is None:
        names = ("baseColorFactor", "baseColorTexture")
        glossy = material.get("pbrMetallicRoughness", {})
    factor, image = names
    colour = _vector(glossy, factor, np.ones(4), place)[:3]
    return _Look(np.nan_to_num(colour), glossy.get(image), place)
