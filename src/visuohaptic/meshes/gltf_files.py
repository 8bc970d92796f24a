"""glTF files, checked to hold what they promise, and how their images go on, which trimesh leaves out."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from typing import Any

from visuohaptic.errors import MeshError
from visuohaptic.geometry.texture import CLAMP, MIRROR, REPEAT
from visuohaptic.meshes.claims import COMPONENT_BYTES, COMPONENTS, gltf_json

_READ_EXTENSIONS = ("EXT_texture_webp", "KHR_lights_punctual")
_MATERIALS = "KHR_materials_"  # the shine of a surface; its colour is read without them
_NO_SURFACE = {0, 1, 2, 3}  # points and lines
_FAN = 6
_TRIANGLES = {4, 5}  # and strips
_WRAPS = {10497: REPEAT, 33071: CLAMP, 33648: MIRROR}


def check_gltf(data: bytes, kind: str, resolver: Any) -> None:
    """Refuse a file that trimesh would read as another surface.

    `kind` is ``glb`` or ``gltf``; `resolver` gives the buffers beside it. Raises `MeshError` with the
    reason alone, if an extension is required that is not read, if a part is a fan of triangles, or
    if buffers, views and accessors are shorter than what they promise.
    """
    document = json.loads(gltf_json(data, kind))
    _check_extensions(document)
    for place, buffer in enumerate(document.get("buffers", ())):
        held = _held_bytes(buffer, data, kind, resolver)
        _check_length(f"buffer {place}", buffer["byteLength"], held)
    for place, view in enumerate(document.get("bufferViews", ())):
        end = view.get("byteOffset", 0) + view["byteLength"]
        held = document["buffers"][view["buffer"]]["byteLength"]
        _check_length(f"the buffer of view {place}", end, held)
    for place in sorted(set(_used_accessors(document))):
        _check_accessor(document, place)


def _check_extensions(document: dict[str, Any]) -> None:
    for name in document.get("extensionsRequired", ()):
        if name not in _READ_EXTENSIONS and not name.startswith(_MATERIALS):
            raise MeshError(
                f"it requires the extension {str(name)[:80]}, which is not read; export it without"
            )


def _held_bytes(buffer: dict[str, Any], data: bytes, kind: str, resolver: Any) -> int:
    uri = buffer.get("uri")
    if uri is None:
        start = 20 + len(gltf_json(data, kind))
        return 0 if kind == "gltf" else int.from_bytes(data[start : start + 4], "little")
    if uri.startswith("data:"):
        return len(base64.b64decode(uri.partition(",")[2]))
    if resolver is None:
        raise MeshError(f"it refers to {uri!r}, and nothing is beside it; export it as .glb")
    return len(resolver.get(uri))


def _check_length(what: str, promised: int, held: int) -> None:
    if promised > held:
        raise MeshError(
            f"it is truncated: {what} is promised to have {promised} bytes, and {held} are there"
        )


def _used_accessors(document: dict[str, Any]) -> Iterator[int]:
    for mesh in document.get("meshes", ()):
        for part in mesh["primitives"]:
            mode = part.get("mode", 4)
            if mode in _NO_SURFACE:
                continue
            if mode not in _TRIANGLES:
                what = "a fan of triangles" if mode == _FAN else f"of mode {mode}"
                raise MeshError(f"one of its parts is {what}; triangles or strips are needed")
            yield part["attributes"]["POSITION"]
            if "indices" in part:
                yield part["indices"]


def _check_accessor(document: dict[str, Any], place: int) -> None:
    accessor = document["accessors"][place]
    if "sparse" in accessor:
        raise MeshError(
            f"accessor {place} is sparse, which is not read; export it as plain numbers"
        )
    if "bufferView" not in accessor:
        raise MeshError(f"accessor {place} promises {accessor['count']} rows and has no data")
    view = document["bufferViews"][accessor["bufferView"]]
    row = COMPONENTS[accessor["type"]] * COMPONENT_BYTES[accessor["componentType"]]
    stride = view.get("byteStride", row)
    end = accessor.get("byteOffset", 0) + stride * (accessor["count"] - 1) + row
    _check_length(f"the view of accessor {place}", end, view["byteLength"])


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
