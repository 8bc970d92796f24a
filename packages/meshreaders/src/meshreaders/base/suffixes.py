"""Suffixes of the files that are read."""

from __future__ import annotations

MODEL_SUFFIXES = (".obj", ".ply", ".stl", ".glb", ".gltf", ".off", ".3mf", ".dae")
"""Suffixes of models, in lower case."""

COMPANION_SUFFIXES = (
    *(".mtl", ".bin"),
    *(".png", ".jpg", ".jpeg", ".bmp", ".tga", ".webp", ".tif", ".tiff", ".gif"),
)
"""Suffixes of materials, buffers and textures, which a model may refer to in its folder or below."""

WITH_COMPANIONS = (".obj", ".ply", ".glb", ".gltf", ".dae")
"""Suffixes of models that may refer to companions."""


def why_unreadable(suffix: str) -> str | None:
    """Return why files of a suffix can't be read; None if they can."""
    if suffix.lower() in MODEL_SUFFIXES:
        return None
    ending = repr(suffix) if suffix else "nothing"
    return f"ends in {ending}, which can't be read; export it as .glb or .obj."
