"""Read the images of a model, and combine them to the texture of a surface."""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray
from meshreaders.base.errors import MeshError
from meshreaders.base.srgb import decode_srgb, encode_srgb
from meshreaders.base.texture import CLAMP, NO_IMAGE, REPEAT, Texture, halve

if TYPE_CHECKING:
    from PIL.Image import Image

MOST_PIXELS = 8192 * 8192
"""Largest number of pixels of an image; a small packed file may have many more."""

MOST_PIXELS_TOGETHER = 16 * MOST_PIXELS
"""Largest number of pixels of all images of a model."""

MOST_TEXELS = 4096 * 4096
"""Largest number of texels of all images of a surface; larger images are halved until they fit."""

IMAGE_FORMATS = ("AVIF", "BMP", "GIF", "JPEG", "PNG", "TGA", "TIFF", "WEBP")
"""Formats that are read with Pillow; some other formats start programs, such as EPS."""

# An image that is repeated more often than this across a face looks uniform from any distance.
_FARTHEST = 2.0**20


@dataclass(frozen=True, eq=False)
class PackedImage:
    """An encoded image; its pixels are decoded at each use, to save memory.

    Attributes
    ----------
    data : bytes
        Content of the image file.
    size : tuple of int
        Width and height, in pixels.
    """

    data: bytes
    size: tuple[int, int]


@dataclass(frozen=True)
class Paint:
    """An image on the faces of a part.

    Attributes
    ----------
    image : PackedImage or PIL.Image.Image
        The image; encoded if it comes from a file.
    corners : numpy.ndarray
        Shape (f, 3, 2), float: image coordinates of each corner; (0, 0) is lower left and (1, 1) upper right.
    wraps : tuple of int
        `REPEAT`, `CLAMP` or `MIRROR`, for u and v.
    tint : tuple of float
        Factors of red, green and blue, 0 to 1.
    linear : bool
        Whether the tint multiplies linear light, as in glTF, or stored sRGB numbers, as in an MTL file.
    """

    image: PackedImage | Image
    corners: FloatArray
    wraps: tuple[int, int] = (REPEAT, REPEAT)
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    linear: bool = False

    @property
    def key(self) -> tuple[object, ...]:
        """Key of the decoded image: paints with equal keys share an image of the texture."""
        return id(self.image), self.wraps, self.tint, self.linear


def open_image(data: bytes, name: str) -> PackedImage | None:
    """Read the size of an encoded image; return None if the format is not read.

    Raises `MeshError` with `name` and reason if the image has more pixels than `MOST_PIXELS`.
    """
    import PIL.Image

    try:
        with _opened(data) as image:
            width, height = image.size
    except PIL.Image.DecompressionBombError as error:
        raise MeshError(f"{name} has too many pixels; {MOST_PIXELS} are allowed") from error
    except (OSError, ValueError):
        return None
    if width * height > MOST_PIXELS:
        raise MeshError(f"{name} has {width} × {height} pixels; {MOST_PIXELS} are allowed")
    return PackedImage(data, (width, height))


def add_textures(
    paints: Sequence[Paint | None], counts: Sequence[int], colours: NDArray[np.uint8]
) -> tuple[NDArray[np.uint8], Texture | None]:
    """Compute colours (f, 3), uint8, sRGB, and images of the faces of parts, one part after another.

    `paints` and `counts` have the image and the number of faces per part. A face with an image has the mean of the
    image as its colour; other faces keep `colours`. Transparency is ignored. The texture is None if all images
    have a single colour.
    """
    texture = _texture_of(paints, counts)
    if texture is None:
        return colours, None
    colours = np.where(texture.textured[:, None], texture.face_colours(), colours)
    return colours, _without_plain_images(texture)


def _texture_of(paints: Sequence[Paint | None], counts: Sequence[int]) -> Texture | None:
    distinct = {paint.key: paint for paint in paints if paint is not None}
    if not distinct:
        return None
    index_of = {key: index for index, key in enumerate(distinct)}
    images = _read_images(list(distinct.values()))
    return Texture(
        np.concatenate([_corners(*pair) for pair in zip(paints, counts, strict=True)]),
        np.concatenate(
            [
                np.full(count, NO_IMAGE if paint is None else index_of[paint.key], np.int32)
                for paint, count in zip(paints, counts, strict=True)
            ]
        ),
        images,
        np.array([paint.wraps for paint in distinct.values()], dtype=np.uint8),
    )


def _corners(paint: Paint | None, count: int) -> NDArray[np.float32]:
    if paint is None:
        return np.zeros((count, 3, 2), dtype=np.float32)
    if np.shape(paint.corners) != (count, 3, 2):
        raise MeshError(
            f"image coordinates have the shape {np.shape(paint.corners)}; ({count}, 3, 2) is needed"
        )
    corners = np.clip(
        np.nan_to_num(np.asarray(paint.corners, dtype=np.float64)), -_FARTHEST, _FARTHEST
    )
    # Repeated and mirrored images have period 2. Coordinates near 0 have the highest precision in float32.
    whole_images = 2.0 * np.floor(corners.min(axis=1, keepdims=True) / 2.0)
    return (corners - whole_images * (np.array(paint.wraps) != CLAMP)).astype(np.float32)


def _read_images(paints: Sequence[Paint]) -> tuple[NDArray[np.uint8], ...]:
    sizes = np.array([paint.image.size for paint in paints], dtype=np.int64)
    for width, height in sizes:
        if width * height > MOST_PIXELS:
            raise MeshError(f"A texture has {width} × {height} pixels; {MOST_PIXELS} are allowed.")
    if sizes.prod(axis=1).sum() > MOST_PIXELS_TOGETHER:
        raise MeshError(
            f"Textures have {sizes.prod(axis=1).sum()} pixels together; "
            f"{MOST_PIXELS_TOGETHER} are allowed."
        )
    # The last of these halvings leaves a texel per image.
    for halvings in range(int(sizes.max()).bit_length()):
        if np.maximum(sizes >> halvings, 1).prod(axis=1).sum() <= MOST_TEXELS:
            return tuple(_read_image(paint, halvings) for paint in paints)
    raise MeshError(f"It has {len(paints)} textures; {MOST_TEXELS} are allowed.")


def _read_image(paint: Paint, halvings: int) -> NDArray[np.uint8]:
    try:
        image = _pixels(paint.image)
    # Pillow may raise any error for a broken image.
    except Exception as error:
        raise MeshError(f"A texture can't be read: {error}") from error
    if paint.tint != (1.0, 1.0, 1.0):
        image = _tinted(image, paint)
    for _ in range(halvings):
        image = halve(image)
    return image


def _opened(data: bytes) -> Image:
    import PIL.Image

    with warnings.catch_warnings():
        # `open_image` checks the number of pixels before they are decoded.
        warnings.simplefilter("ignore", PIL.Image.DecompressionBombWarning)
        return PIL.Image.open(io.BytesIO(data), formats=IMAGE_FORMATS)


def _pixels(image: PackedImage | Image) -> NDArray[np.uint8]:
    if isinstance(image, PackedImage):
        with _opened(image.data) as opened:
            return _pixels(opened)
    if not image.mode.startswith("I;16"):
        return np.asarray(image.convert("RGB"))
    # Pillow would clip 16-bit values at 255.
    grey = np.rint(np.asarray(image) / 257.0).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=-1)


def _tinted(image: NDArray[np.uint8], paint: Paint) -> NDArray[np.uint8]:
    stored, tint = np.arange(256)[:, None] / 255.0, np.array(paint.tint)
    tinted = encode_srgb(decode_srgb(stored) * tint) if paint.linear else stored * tint
    table = np.rint(255.0 * tinted).astype(np.uint8)
    return np.stack([table[:, channel][image[..., channel]] for channel in range(3)], axis=-1)


def _without_plain_images(texture: Texture) -> Texture | None:
    """Return the texture without images of a single colour, which face colours replace; None if no image is left."""
    kept_images = [
        index for index, image in enumerate(texture.images) if (image != image[0, 0]).any()
    ]
    if not kept_images:
        return None
    new_index = np.full(len(texture.images) + 1, NO_IMAGE, dtype=np.int32)
    new_index[kept_images] = np.arange(len(kept_images))
    images = tuple(texture.images[index] for index in kept_images)
    # Index -1, `NO_IMAGE`, selects the last entry.
    return replace(
        texture, image=new_index[texture.image], images=images, wraps=texture.wraps[kept_images]
    )
