"""glTF files, checked for what trimesh reads as another surface, and how their images go on, which it leaves out."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.texture import CLAMP, MIRROR, REPEAT
from visuohaptic.meshes.limits import check_parts

_READ_EXTENSIONS = ("EXT_texture_webp", "KHR_lights_punctual")
_MATERIALS = "KHR_materials_"  # the shine of a surface; its colour is read without them
_NO_SURFACE = {0, 1, 2, 3}  # points and lines
_TRIANGLES = {4, 5}  # and strips
_WRAPS = {10497: REPEAT, 33071: CLAMP, 33648: MIRROR}


def gltf_document(data: bytes, kind: str) -> dict[str, Any]:
    """Give the JSON of a file of kind ``glb`` or ``gltf``; raises `ValueError` if it has none."""
    if kind == "glb":
        promised = int.from_bytes(data[8:12], "little")
        if data[:4] != b"glTF" or data[16:20] != b"JSON":
            raise MeshError("it does not begin as a GLB does")
        if len(data) < promised:
            raise MeshError(
                f"it is truncated: its header promises {promised} bytes, and {len(data)} are there"
            )
        data = data[20 : 20 + int.from_bytes(data[12:16], "little")]
    document: dict[str, Any] = json.loads(data)
    return document


def check_gltf(document: dict[str, Any], size: int) -> None:
    """Refuse a document, in a file of `size` bytes, that trimesh would read as another surface, or without end.

    Buffers and views that are shorter than promised are refused by trimesh. Raises `MeshError` with
    the reason alone, if an extension is required that is not read, if a part is a fan of triangles
    or has no plain numbers, or for too many parts, corners, or rows without data.
    """
    for name in document.get("extensionsRequired", ()):
        if name not in _READ_EXTENSIONS and not name.startswith(_MATERIALS):
            raise MeshError(
                f"it requires the extension {str(name)[:80]}, which is not read; export it without"
            )
    accessors = document.get("accessors", [])
    meshes = [
        [_corners(accessors, part) for part in mesh["primitives"]]
        for mesh in document.get("meshes", ())
    ]
    nodes = document.get("nodes", ())
    shown = meshes + [meshes[node["mesh"]] for node in nodes if "mesh" in node]
    parts = max(len(nodes), sum(map(len, meshes)))
    check_parts(parts, "nodes or primitives", sum(map(sum, shown)))
    empty = sum(one["count"] for one in accessors if "bufferView" not in one)
    if empty > size:
        raise MeshError(f"it claims {empty} rows without data in a file of {size} bytes")
    for place in {*_surface_accessors(document)}:
        if "bufferView" not in accessors[place] or "sparse" in accessors[place]:
            raise MeshError(
                f"accessor {place} is sparse or has no data; export it as plain numbers"
            )


def _corners(accessors: list[dict[str, Any]], part: dict[str, Any]) -> int:
    places = [*part["attributes"].values(), part.get("indices")]
    return sum(int(accessors[place]["count"]) for place in places if place is not None)


def _surface_accessors(document: dict[str, Any]) -> Iterator[int]:
    for mesh in document.get("meshes", ()):
        for part in mesh["primitives"]:
            mode = part.get("mode", 4)
            if mode in _NO_SURFACE:
                continue
            if mode not in _TRIANGLES:
                raise MeshError(
                    f"one of its parts is of mode {mode}, such as a fan of triangles; triangles or "
                    "strips are needed"
                )
            yield part["attributes"]["POSITION"]
            if "indices" in part:
                yield part["indices"]


def add_wraps(scene: Any, document: dict[str, Any]) -> None:
    """Give the materials of a scene, as `wraps`, what the samplers of its file say.

    `scene` is what trimesh read from `document`: a geometry for each primitive, in the same order.
    """
    parts = [
        part
        for mesh in document.get("meshes", ())
        for part in mesh["primitives"]
        if part.get("mode", 4) in {0, 1, *_TRIANGLES}
    ]
    if len(parts) != len(scene.geometry):
        return
    for part, geometry in zip(parts, scene.geometry.values(), strict=True):
        if "material" in part and hasattr(geometry.visual, "material"):
            geometry.visual.material.wraps = _wraps(document, part["material"])


def _wraps(document: dict[str, Any], material: int) -> tuple[int, int]:
    base = document["materials"][material].get("pbrMetallicRoughness", {}).get("baseColorTexture")
    if base is None:
        return REPEAT, REPEAT
    sampler = document["textures"][base["index"]].get("sampler")
    known: dict[str, Any] = {} if sampler is None else document["samplers"][sampler]
    across, up = (_WRAPS.get(known.get(name, 10497), REPEAT) for name in ("wrapS", "wrapT"))
    return across, up
