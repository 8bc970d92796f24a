"""One colour a face, from the materials, textures and colours of a trimesh mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MeshError
from visuohaptic.meshes.in_memory import GREY

if TYPE_CHECKING:
    from PIL.Image import Image

MOST_PIXELS = 8192 * 8192
"""A texture of more is refused: packed, it may be a small file."""

# Centroid and three points half-way to the corners: what a texture looks like over a face.
_TEXTURE_SAMPLES = np.array(
    [[1 / 3, 1 / 3, 1 / 3], [2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]]
)


def face_colours(part: Any) -> NDArray[np.uint8]:
    """Give each face its colour.

    Parameters
    ----------
    part : trimesh.Trimesh
        A mesh of f faces.

    Returns
    -------
    numpy.ndarray
        Shape (f, 3), uint8, sRGB: the material's diffuse colour, the mean of the texture over
        the face, or the mean of the corners' colours; `GREY` where there is none.
    """
    visual, count = part.visual, len(part.faces)
    if visual.kind == "texture":
        return _material_colours(visual, np.asarray(part.faces))
    if visual.kind == "vertex":
        corners = np.asarray(visual.vertex_colors)[part.faces][..., :3]
        return np.rint(corners.mean(axis=1)).astype(np.uint8)
    if visual.kind == "face":
        return np.asarray(visual.face_colors)[:, :3].astype(np.uint8)
    return np.tile(np.array(GREY, dtype=np.uint8), (count, 1))


def _material_colours(visual: Any, faces: NDArray[np.int64]) -> NDArray[np.uint8]:
    material = visual.material
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if image is not None and visual.uv is not None:
        return _sample_texture(image, np.asarray(visual.uv, dtype=np.float64)[faces])
    colour = np.asarray(material.main_color)[:3].astype(np.uint8)
    return np.tile(colour, (len(faces), 1))


def _sample_texture(image: Image, corner_uv: NDArray[np.float64]) -> NDArray[np.uint8]:
    if image.width * image.height > MOST_PIXELS:
        raise MeshError(
            f"A texture has {image.width} × {image.height} pixels; {MOST_PIXELS} are allowed."
        )
    pixels = np.asarray(image.convert("RGB"))
    height, width = pixels.shape[:2]
    uv = np.nan_to_num(np.einsum("sc,fck->fsk", _TEXTURE_SAMPLES, corner_uv)) % 1.0
    column = np.minimum((uv[..., 0] * width).astype(np.int64), width - 1)
    row = np.minimum(((1.0 - uv[..., 1]) * height).astype(np.int64), height - 1)
    return np.rint(pixels[row, column].mean(axis=1)).astype(np.uint8)
