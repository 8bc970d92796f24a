"""The images of a trimesh mesh or scene, made ready for a surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.srgb import decode_srgb, encode_srgb
from visuohaptic.geometry.texture import CLAMP, NO_IMAGE, REPEAT, Texture, halve

if TYPE_CHECKING:
    from PIL.Image import Image

MOST_PIXELS = 8192 * 8192
"""An image of more is refused: packed, it may be a small file."""

MOST_PIXELS_TOGETHER = 16 * MOST_PIXELS
"""All images of a model with more are refused."""

MOST_TEXELS = 4096 * 4096
"""Texels of all images of a surface: larger images are halved until they fit."""

# An image that is repeated more often than this across a face has one colour from anywhere.
_FARTHEST = 2.0**20


@dataclass(frozen=True)
class _Painted:
    """An image as a material shows it: how it goes on, and the colour that multiplies it, as light or stored."""

    image: Image
    wraps: tuple[int, int]
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    linear: bool = False

    @property
    def key(self) -> tuple[object, ...]:
        return id(self.image), self.wraps, self.tint, self.linear


def add_textures(
    parts: Sequence[Any], colours: NDArray[np.uint8]
) -> tuple[NDArray[np.uint8], Texture | None]:
    """Give the colours (f, 3), uint8, sRGB, and the images of the faces of parts, one part after another.

    Each part has `vertices`, `faces` and a trimesh `visual`. Faces with an image have the mean of
    it as their colour, others the given one. Images are multiplied by their material's colour: glTF's
    base colour as light, an MTL's `Kd` as stored, unless it is black, as some programs write it
    beside an image. Transparency is left out. There is no texture if no image has more than one colour.
    """
    texture = _texture_of(parts)
    if texture is None:
        return colours, None
    colours = np.where(texture.textured[:, None], texture.face_colours(), colours)
    return colours, _without_plain_images(texture)


def _texture_of(parts: Sequence[Any]) -> Texture | None:
    painted = [_painted(part) for part in parts]
    distinct = {one.key: one for one in painted if one is not None}
    if not distinct:
        return None
    numbers = {key: number for number, key in enumerate(distinct)}
    images = _read_images(list(distinct.values()))
    return Texture(
        np.concatenate([_corners(*pair) for pair in zip(parts, painted, strict=True)]),
        np.concatenate(
            [
                np.full(len(part.faces), NO_IMAGE if one is None else numbers[one.key], np.int32)
                for part, one in zip(parts, painted, strict=True)
            ]
        ),
        images,
        np.array([one.wraps for one in distinct.values()], dtype=np.uint8),
    )


def _painted(part: Any) -> _Painted | None:
    if part.visual.kind != "texture":
        return None
    material: Any = part.visual.material
    places: Any = part.visual.uv
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if image is None or np.shape(places) != (len(part.vertices), 2):
        return None
    wraps = getattr(material, "wraps", (REPEAT, REPEAT))
    base = getattr(material, "baseColorFactor", None)
    if base is not None:
        return _Painted(image, wraps, _triple(np.asarray(base) / 255.0), linear=True)
    # trimesh gives a diffuse colour to a material that has none: what the file says is beside it.
    diffuse: Any = getattr(material, "kwargs", {}).get("kd")
    if np.shape(diffuse) != (3,) or not np.any(diffuse):
        return _Painted(image, wraps)
    return _Painted(image, wraps, _triple(diffuse))


def _triple(values: Any) -> tuple[float, float, float]:
    red, green, blue = np.clip(np.nan_to_num(np.asarray(values, dtype=np.float64)[:3]), 0, 1)
    return float(red), float(green), float(blue)


def _corners(part: Any, painted: _Painted | None) -> NDArray[np.float32]:
    if painted is None:
        return np.zeros((len(part.faces), 3, 2), dtype=np.float32)
    places = np.nan_to_num(np.asarray(part.visual.uv, dtype=np.float64))
    corners = np.clip(places, -_FARTHEST, _FARTHEST)[np.asarray(part.faces)]
    # Where images are repeated or mirrored, an even number of them away is the same place, and near 0
    # float32 is finest.
    away = 2.0 * np.floor(corners.min(axis=1, keepdims=True) / 2.0)
    return (corners - away * (np.array(painted.wraps) != CLAMP)).astype(np.float32)


def _read_images(painted: Sequence[_Painted]) -> tuple[NDArray[np.uint8], ...]:
    sizes = np.array([one.image.size for one in painted], dtype=np.int64)
    for width, height in sizes:
        if width * height > MOST_PIXELS:
            raise MeshError(f"A texture has {width} × {height} pixels; {MOST_PIXELS} are allowed.")
    if sizes.prod(axis=1).sum() > MOST_PIXELS_TOGETHER:
        raise MeshError(
            f"Textures have {sizes.prod(axis=1).sum()} pixels together; "
            f"{MOST_PIXELS_TOGETHER} are allowed."
        )
    halvings = 0
    while np.maximum(sizes >> halvings, 1).prod(axis=1).sum() > MOST_TEXELS:
        halvings += 1
    return tuple(_read_image(one, halvings) for one in painted)


def _read_image(painted: _Painted, halvings: int) -> NDArray[np.uint8]:
    try:
        image = _pixels(painted.image)
    # A broken image may fail in any way.
    except Exception as error:
        raise MeshError(f"A texture can't be read: {error}") from error
    if painted.tint != (1.0, 1.0, 1.0):
        image = _tinted(image, painted)
    for _ in range(halvings):
        image = halve(image)
    return image


def _pixels(image: Image) -> NDArray[np.uint8]:
    if not image.mode.startswith("I;16"):
        return np.asarray(image.convert("RGB"))
    # Pillow would cut 16 bits off at 255.
    grey = np.rint(np.asarray(image) / 257.0).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=-1)


def _tinted(image: NDArray[np.uint8], painted: _Painted) -> NDArray[np.uint8]:
    stored, tint = np.arange(256)[:, None] / 255.0, np.array(painted.tint)
    seen = encode_srgb(decode_srgb(stored) * tint) if painted.linear else stored * tint
    table = np.rint(255.0 * seen).astype(np.uint8)
    return np.stack([table[:, channel][image[..., channel]] for channel in range(3)], axis=-1)


def _without_plain_images(texture: Texture) -> Texture | None:
    """Leave out images of one colour, such as trimesh has for a material that it doesn't find."""
    kept = [number for number, image in enumerate(texture.images) if (image != image[0, 0]).any()]
    if not kept:
        return None
    numbers = np.full(len(texture.images) + 1, NO_IMAGE, dtype=np.int32)
    numbers[kept] = np.arange(len(kept))
    images = tuple(texture.images[number] for number in kept)
    # The last number stands for `NO_IMAGE`, which is -1.
    return replace(texture, image=numbers[texture.image], images=images, wraps=texture.wraps[kept])
