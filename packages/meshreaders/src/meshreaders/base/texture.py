"""Images on the faces of a surface, and the mean light of patches of the images."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import BoolArray, FloatArray, IntArray
from meshreaders.base.srgb import decode_srgb, encode_bytes

WRAPS = REPEAT, CLAMP, MIRROR = 0, 1, 2
"""How an image continues beyond its edges: repeated, with its last texels, or mirrored."""

NO_IMAGE = -1
"""Index of the image of a face without an image."""

MOST_SQUARES = 16
"""Largest number of squares that approximate a patch; the patch may be so many times longer than wide."""

_LIGHT = decode_srgb(np.arange(256) / 255.0)
_LEAST_WIDTH = 2.0**-20  # texels
_LONGEST = 2.0**20  # largest side of a patch, in sides of its face
_ALMOST = 1.1
_STRIP_ROWS = 256  # rows that are halved at once, so that less than 100 MB are needed
_AT_ONCE = 1 << 16  # faces or patches

# Centroids of the four triangles that result from cutting a triangle at the middles of its edges.
_QUARTERS = np.array(
    [[1 / 3, 1 / 3, 1 / 3], [2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]]
)


@dataclass(frozen=True, eq=False)
class Texture:
    """Images on faces; a texel is one colour of an image, a square.

    Attributes
    ----------
    corners : ndarray of shape (f, 3, 2), float32
        Texture coordinates of the corners of each face: (0, 0) is the lower left of the image, (1, 1) the upper right.
    image : ndarray of shape (f,), int32
        Index of the image of each face, or `NO_IMAGE`.
    images : tuple of ndarray of shape (h, w, 3), uint8
        sRGB images, the upper row first.
    wraps : ndarray of shape (i, 2), uint8
        `REPEAT`, `CLAMP` or `MIRROR` of each image, horizontally and vertically.
    """

    corners: NDArray[np.float32]
    image: NDArray[np.int32]
    images: tuple[NDArray[np.uint8], ...]
    wraps: NDArray[np.uint8]

    @property
    def textured(self) -> BoolArray:
        """Whether each face has an image, shape (f,)."""
        return self.image != NO_IMAGE

    def texels(self) -> NDArray[np.uint8]:
        """Return the texels of all images, image by image and row by row, shape (t, 3)."""
        return np.concatenate([image.reshape(-1, 3) for image in self.images])

    def take(self, faces: BoolArray | NDArray[np.integer]) -> Texture:
        """Return the texture of the faces with some indices, or of the faces for which a mask (f,) is true."""
        return replace(self, corners=self.corners[faces], image=self.image[faces])

    def light(self, faces: IntArray, weights: FloatArray, steps: FloatArray) -> FloatArray:
        """Compute the mean linear light of patches of faces that have an image.

        A patch is a parallelogram on a face. It is approximated by the ellipse that its sides span, and the ellipse by
        equal squares along its longer axis, as in anisotropic filters of graphics cards
        (``EXT_texture_filter_anisotropic``). The number of squares is the smallest for which a square is at most a tenth
        wider than the ellipse, but at most `MOST_SQUARES`.

        A square up to 1 texel wide has the mean of the four texels around its centre, weighted by covered area. A
        square of 2^k to 2^(k + 1) texels is interpolated between the images that are halved k and k + 1 times
        (Williams 1983, "Pyramidal parametrics"). All means are of linear light.

        Parameters
        ----------
        faces : ndarray of shape (n,), int64
            Face of each patch.
        weights : ndarray of shape (n, 3)
            Barycentric weights of the centre of each patch.
        steps : ndarray of shape (n, 2, 2)
            Change of the second and third weight along each of the two sides of a patch.

        Returns
        -------
        ndarray of shape (n, 3)
            Linear light, 0 to 1.
        """
        blocks = [slice(start, start + _AT_ONCE) for start in range(0, len(faces), _AT_ONCE)]
        light = [self._patch_light(faces[block], weights[block], steps[block]) for block in blocks]
        return np.concatenate([np.zeros((0, 3)), *light])

    def face_colours(self) -> NDArray[np.uint8]:
        """Compute the mean sRGB colour of each face, shape (f, 3); black for a face without an image."""
        colours = np.zeros((len(self.image), 3), dtype=np.uint8)
        textured = np.flatnonzero(self.textured)
        for start in range(0, len(textured), _AT_ONCE):
            faces = textured[start : start + _AT_ONCE]
            colours[faces] = encode_bytes(self._face_light(faces))
        return colours

    def _patch_light(self, faces: IntArray, weights: FloatArray, steps: FloatArray) -> FloatArray:
        corners, image = self.corners.take(faces, axis=0).astype(np.float64), self.image.take(faces)
        centre = _at(weights.T[:, :, None], corners)
        size = self._pyramid.sizes.take(image, axis=0)
        edges = (corners[:, 1:] - corners[:, :1]) * size[:, None]
        steps = np.clip(np.nan_to_num(steps), -_LONGEST, _LONGEST)
        first, second = (
            steps[:, side, 0, None] * edges[:, 0] + steps[:, side, 1, None] * edges[:, 1]
            for side in range(2)
        )
        longer, long, wide = _ellipse(first, second)
        widest = np.maximum(_ALMOST * wide, long / MOST_SQUARES)
        count = np.ceil(np.divide(long, widest, out=np.ones_like(long), where=widest > 0))
        count = count.astype(np.int64)

        patch = np.repeat(np.arange(len(faces)), count)
        start = np.cumsum(count) - count
        along = (np.arange(len(patch)) - start.take(patch) + 0.5) / count.take(patch) - 0.5
        middles = (longer / size).take(patch, axis=0) * along[:, None]
        middles += centre.take(patch, axis=0)
        width = np.maximum(wide, long / count)
        squares = self._squares(image.take(patch), middles, width.take(patch))
        light = squares.take(start, axis=0)
        # The mean is a sum of differences from the first square, so that equal colours have exactly their own mean.
        squares -= light.take(patch, axis=0)
        for channel in range(3):
            light[:, channel] += np.bincount(patch, squares[:, channel], len(faces)) / count
        return light

    def _face_light(self, faces: IntArray) -> FloatArray:
        corners, image = self.corners[faces].astype(np.float64), self.image[faces]
        edges = (corners[:, 1:] - corners[:, :1]) * self._pyramid.sizes[image, None]
        area = 0.5 * np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0])
        quarters = [
            self._squares(image, _at(middle, corners), np.sqrt(area / 4)) for middle in _QUARTERS
        ]
        return quarters[0] + sum(quarter - quarters[0] for quarter in quarters) / len(quarters)

    def _squares(
        self, image: NDArray[np.int32], middles: FloatArray, width: FloatArray
    ) -> FloatArray:
        """Compute the light (n, 3) of squares from their centres (n, 2) and widths (n,) in texels."""
        # frexp splits a width exactly into a fraction of 1/2 to 1 and a power of two, on every processor.
        fraction, power = np.frexp(np.maximum(width, 1.0))
        level, upper = power.astype(np.int64) - 1, 2.0 * fraction - 1.0
        light = self._four_texels(image, level, middles, width)
        between = np.flatnonzero(upper)
        coarser = self._four_texels(
            image.take(between), level.take(between) + 1, middles.take(between, axis=0)
        )
        light[between] = _mixed(light.take(between, axis=0), coarser, upper.take(between)[:, None])
        return light

    def _four_texels(
        self,
        image: NDArray[np.int32],
        level: IntArray,
        middles: FloatArray,
        width: FloatArray | None = None,
    ) -> FloatArray:
        pyramid = self._pyramid
        levels = pyramid.first.shape[1]
        entry = image * levels + np.minimum(level, levels - 1)
        first, columns, rows = (
            table.take(entry) for table in (pyramid.first, pyramid.columns, pyramid.rows)
        )
        width = np.ones(1) if width is None else np.clip(width, _LEAST_WIDTH, 1.0)
        wraps = self.wraps.take(image, axis=0)
        column, next_column, across = _neighbours(middles[:, 0], columns, width, wraps[:, 0])
        row, next_row, up = _neighbours(middles[:, 1], rows, width, wraps[:, 1])
        start, next_start = (first + (rows - 1 - index) * columns for index in (row, next_row))
        here = _mixed(pyramid.light(start + column), pyramid.light(start + next_column), across)
        beside = _mixed(
            pyramid.light(next_start + column), pyramid.light(next_start + next_column), across
        )
        return _mixed(here, beside, up)

    @cached_property
    def _pyramid(self) -> _Pyramid:
        return _Pyramid(self.images)


class _Pyramid:
    """Texels of images and of their halvings, down to one texel, in one array."""

    def __init__(self, images: tuple[NDArray[np.uint8], ...]) -> None:
        pyramids = [_halvings(image) for image in images]
        most = max(map(len, pyramids))
        # Smaller images repeat their last level.
        levels = [[*pyramid, *[pyramid[-1]] * (most - len(pyramid))] for pyramid in pyramids]
        self.rows = np.array([[level.shape[0] for level in image] for image in levels])
        self.columns = np.array([[level.shape[1] for level in image] for image in levels])
        self.sizes = np.stack([self.columns[:, 0], self.rows[:, 0]], axis=1).astype(np.float64)
        starts = np.cumsum([0, *map(len, pyramids)])
        ends = np.cumsum([0, *(level[..., 0].size for pyramid in pyramids for level in pyramid)])
        self.first = np.array(
            [
                ends[start + np.minimum(np.arange(most), len(pyramid) - 1)]
                for start, pyramid in zip(starts, pyramids, strict=False)
            ]
        )
        self._texels = np.concatenate(
            [level.reshape(-1, 3) for pyramid in pyramids for level in pyramid]
        )

    def light(self, texels: IntArray) -> FloatArray:
        """Return the linear light (n, 3) of texels by index (n,)."""
        return _LIGHT.take(self._texels.take(texels, axis=0))


def halve(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Compute an image of half the rows and columns from an sRGB image (h, w, 3), uint8.

    Halves are rounded down, to at least 1. Each texel has the mean linear light of the area that it covers.
    """
    rows, columns = (np.arange(max(size // 2, 1)) for size in image.shape[:2])
    strips = np.split(rows, range(_STRIP_ROWS, len(rows), _STRIP_ROWS))
    return np.concatenate([_halved_rows(image, strip, columns) for strip in strips])


def _halved_rows(image: NDArray[np.uint8], rows: IntArray, columns: IntArray) -> NDArray[np.uint8]:
    light = np.zeros((len(rows), image.shape[1], 3))
    for source, share in _covered(image.shape[0], rows):
        light += share[:, None, None] * _LIGHT.take(image.take(source, axis=0))
    halved = np.zeros((len(rows), len(columns), 3))
    for source, share in _covered(image.shape[1], columns):
        halved += share[:, None] * light.take(source, axis=1)
    return encode_bytes(halved)


def _halvings(image: NDArray[np.uint8]) -> list[NDArray[np.uint8]]:
    levels = [image]
    for _ in range(max(image.shape[:2]).bit_length() - 1):
        levels.append(halve(levels[-1]))
    return levels


def _covered(size: int, halves: IntArray) -> list[tuple[IntArray, FloatArray]]:
    """Return the texels, out of `size`, that each texel of a halved row covers, with their shares in the mean."""
    half = size // 2
    if not half:
        return [(halves, np.ones(len(halves)))]
    if size % 2 == 0:
        share = np.full(len(halves), 0.5)
        return [(2 * halves, share), (2 * halves + 1, share)]
    return [
        (2 * halves, (half - halves) / size),
        (2 * halves + 1, np.full(len(halves), half / size)),
        (2 * halves + 2, (halves + 1) / size),
    ]


def _at(weights: FloatArray, corners: FloatArray) -> FloatArray:
    """Compute points (n, 2) from barycentric weights of corners (n, 3, 2)."""
    first, second, third = weights
    return first * corners[:, 0] + second * corners[:, 1] + third * corners[:, 2]


def _ellipse(first: FloatArray, second: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Compute the longer axis (n, 2) and both lengths (n,) of ellipses from two conjugate diameters."""
    # The lengths are the singular values of the matrix whose columns are the diameters.
    xx = first[:, 0] ** 2 + second[:, 0] ** 2
    yy = first[:, 1] ** 2 + second[:, 1] ** 2
    xy = first[:, 0] * first[:, 1] + second[:, 0] * second[:, 1]
    area = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    difference = 0.5 * (xx - yy)
    square = 0.5 * (xx + yy) + np.sqrt(difference**2 + xy**2)
    long = np.sqrt(square)
    wide = np.divide(area, long, out=np.zeros_like(long), where=long > 0)
    # Two formulas give the same axis; choose the one without a difference of nearly equal numbers.
    flat = (difference >= 0)[:, None]
    axis = np.where(flat, np.stack([square - yy, xy], axis=1), np.stack([xy, square - xx], axis=1))
    length = np.sqrt(axis[:, 0] ** 2 + axis[:, 1] ** 2)
    scale = np.divide(long, length, out=np.zeros_like(long), where=length > 0)
    return axis * scale[:, None], long, wide


def _neighbours(
    middles: FloatArray, size: IntArray, width: FloatArray, wrap: NDArray[np.uint8]
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the texel at the centre of a square, the nearer texel beside it, and the share of the latter."""
    position = middles * size
    near = np.floor(position)
    aside = position - near - 0.5
    share = np.clip(0.5 - (0.5 - np.abs(aside)) / width, 0.0, 0.5)
    texel = near.astype(np.int64)
    beside = texel + np.where(aside < 0.0, -1, 1)
    return _wrapped(texel, size, wrap), _wrapped(beside, size, wrap), share[:, None]


def _wrapped(indices: IntArray, size: IntArray, wrap: NDArray[np.uint8]) -> IntArray:
    repeated = indices % size
    if not wrap.any():
        return repeated
    around = indices % (2 * size)
    mirrored = np.minimum(around, 2 * size - 1 - around)
    return np.choose(wrap, [repeated, np.clip(indices, 0, size - 1), mirrored])


def _mixed(first: FloatArray, second: FloatArray, share: FloatArray) -> FloatArray:
    mixed = second - first
    mixed *= share
    mixed += first
    return mixed
