"""How the images of a glTF file go on beyond their edges, which trimesh leaves out."""

from __future__ import annotations

from typing import Any

from visuohaptic.geometry.texture import CLAMP, MIRROR, REPEAT

_WRAPS = {10497: REPEAT, 33071: CLAMP, 33648: MIRROR}
_READ_MODES = {0, 1, 4, 5}  # points, lines, triangles and strips, as trimesh reads them


def add_wraps(scene: Any, document: dict[str, Any]) -> None:
    """Give the materials of a scene, as `wraps`, what the samplers of its file say.

    `scene` is what trimesh read from `document`: a geometry for each primitive, in the same order.
    """
    parts = [
        part
        for mesh in document.get("meshes", ())
        for part in mesh["primitives"]
        if part.get("mode", 4) in _READ_MODES
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
