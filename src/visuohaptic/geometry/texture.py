"""Images upon the faces of a surface, and the light of a patch of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.srgb import decode_srgb, encode_bytes

WRAPS = REPEAT, CLAMP, MIRROR = 0, 1, 2
"""How an image goes on beyond its edges: again, as its last texels, or mirrored."""

NO_IMAGE = -1
"""Image of a face that has none."""

MOST_SQUARES = 16
"""Squares that a patch is cut into at most: it may be so many times longer than wide."""

_LIGHT = decode_srgb(np.arange(256) / 255.0)
_LEAST_WIDTH = 2.0**-20  # texels
_LONGEST = 2.0**20  # of a patch's sides, in those of its face
_ALMOST = 1.1
_STRIP_ROWS = 256  # so that less than 100 MB are needed at a time
_AT_ONCE = 1 << 16

# The middles of the four triangles that a triangle is cut into at the middles of its edges.
_QUARTERS = np.array(
    [[1 / 3, 1 / 3, 1 / 3], [2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]]
)


@dataclass(frozen=True, eq=False)
class Texture:
    """Images upon faces; a texel is one number triple of an image, a square of one colour.

    `corners` (f, 3, 2) are the places of each face's corners in its image, (0, 0) its lower left and
    (1, 1) its upper right. `image` (f,) is the number of each face's image, or `NO_IMAGE`. Each of
    `images` is (h, w, 3), sRGB, the upper row first; `wraps` (i, 2) is `REPEAT`, `CLAMP` or `MIRROR`
    across and up, for each.
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
        """Give all images' texels, one row and image after another, shape (t, 3)."""
        return np.concatenate([image.reshape(-1, 3) for image in self.images])

    def take(self, faces: BoolArray | NDArray[np.integer]) -> Texture:
        """Give the texture of some of the faces."""
        return replace(self, corners=self.corners[faces], image=self.image[faces])

    def light(self, faces: IntArray, weights: FloatArray, steps: FloatArray) -> FloatArray:
        """Give the mean linear light (n, 3), 0 to 1, of patches of faces (n,) that have an image.

        A patch is a parallelogram: `weights` (n, 3) are the barycentric ones of its middle, and
        `steps` (n, 2, 2) say how the second and third weight change along each of its two sides.

        The patch is taken for the ellipse that its sides span, and that for equal squares along its
        longer axis, as graphics cards filter anisotropically (`EXT_texture_filter_anisotropic`): as
        few as are at most a tenth wider than the ellipse, but no more than `MOST_SQUARES`. A square
        w texels wide gets, for w up to 1, the mean of the four texels around its middle by the
        share of the square that each covers; for w between 2^k and 2^(k + 1) the mean by w of what
        two images give, halved k and k + 1 times (Williams 1983, Pyramidal parametrics). Means are
        of linear light.
        """
        parts = [slice(start, start + _AT_ONCE) for start in range(0, len(faces), _AT_ONCE)]
        found = [self._patch_light(faces[part], weights[part], steps[part]) for part in parts]
        return np.concatenate([np.zeros((0, 3)), *found])

    def face_colours(self) -> NDArray[np.uint8]:
        """Give the mean colour of each face, shape (f, 3), sRGB; black where there is no image."""
        colours = np.zeros((len(self.image), 3), dtype=np.uint8)
        textured = np.flatnonzero(self.textured)
        for start in range(0, len(textured), _AT_ONCE):
            faces = textured[start : start + _AT_ONCE]
            colours[faces] = encode_bytes(self._face_light(faces))
        return colours

    def _patch_light(self, faces: IntArray, weights: FloatArray, steps: FloatArray) -> FloatArray:
        corners, image = self.corners.take(faces, axis=0).astype(np.float64), self.image.take(faces)
        place = _at(weights.T[:, :, None], corners)
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
        middles += place.take(patch, axis=0)
        width = np.maximum(wide, long / count)
        squares = self._squares(image.take(patch), middles, width.take(patch))
        one = squares.take(start, axis=0)
        # So that equal colours have exactly their own mean.
        squares -= one.take(patch, axis=0)
        for channel in range(3):
            one[:, channel] += np.bincount(patch, squares[:, channel], len(faces)) / count
        return one

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
        """Give the light of squares by their middles, shape (n, 2), and widths in texels."""
        # A number is a fraction, 1/2 to 1, times a power of two: exactly, on every processor.
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
        one = image * levels + np.minimum(level, levels - 1)
        first, columns, rows = (
            table.take(one) for table in (pyramid.first, pyramid.columns, pyramid.rows)
        )
        width = np.ones(1) if width is None else np.clip(width, _LEAST_WIDTH, 1.0)
        wraps = self.wraps.take(image, axis=0)
        column, next_column, across = _neighbours(middles[:, 0], columns, width, wraps[:, 0])
        row, next_row, up = _neighbours(middles[:, 1], rows, width, wraps[:, 1])
        start, next_start = (first + (rows - 1 - one) * columns for one in (row, next_row))
        here = _mixed(pyramid.light(start + column), pyramid.light(start + next_column), across)
        beside = _mixed(
            pyramid.light(next_start + column), pyramid.light(next_start + next_column), across
        )
        return _mixed(here, beside, up)

    @cached_property
    def _pyramid(self) -> _Pyramid:
        return _Pyramid(self.images)


class _Pyramid:
    """Images, each also halved until one texel is left, behind each other."""

    def __init__(self, images: tuple[NDArray[np.uint8], ...]) -> None:
        pyramids = [_halvings(image) for image in images]
        most = max(map(len, pyramids))
        # Beyond an image's last level is its last again.
        levels = [[*pyramid, *[pyramid[-1]] * (most - len(pyramid))] for pyramid in pyramids]
        self.rows = np.array([[level.shape[0] for level in one] for one in levels])
        self.columns = np.array([[level.shape[1] for level in one] for one in levels])
        self.sizes = np.stack([self.columns[:, 0], self.rows[:, 0]], axis=1).astype(np.float64)
        starts = np.cumsum([0, *(len(one) for one in pyramids)])
        ends = np.cumsum([0, *(level[..., 0].size for one in pyramids for level in one)])
        self.first = np.array(
            [
                ends[start + np.minimum(np.arange(most), len(one) - 1)]
                for start, one in zip(starts, pyramids, strict=False)
            ]
        )
        self._texels = np.concatenate([level.reshape(-1, 3) for one in pyramids for level in one])

    def light(self, texels: IntArray) -> FloatArray:
        return _LIGHT.take(self._texels.take(texels, axis=0))


def halve(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Give an image of half the rows and columns, rounded down but at least one.

    Each texel has the mean light of the area that it covers; `image` has the shape (h, w, 3), sRGB.
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
    while max(levels[-1].shape[:2]) > 1:
        levels.append(halve(levels[-1]))
    return levels


def _covered(size: int, places: IntArray) -> list[tuple[IntArray, FloatArray]]:
    """Give which of `size` texels in a row each of half as many covers, and the shares of them."""
    half = size // 2
    if not half:
        return [(places, np.ones(len(places)))]
    if size % 2 == 0:
        share = np.full(len(places), 0.5)
        return [(2 * places, share), (2 * places + 1, share)]
    return [
        (2 * places, (half - places) / size),
        (2 * places + 1, np.full(len(places), half / size)),
        (2 * places + 2, (places + 1) / size),
    ]


def _at(weights: FloatArray, corners: FloatArray) -> FloatArray:
    """Give places by barycentric weights of corners, shape (n, 3, 2)."""
    first, second, third = weights
    return first * corners[:, 0] + second * corners[:, 1] + third * corners[:, 2]


def _ellipse(first: FloatArray, second: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Give the longer axis, shape (n, 2), and both lengths of ellipses with conjugate diameters."""
    # The lengths are the singular values of the matrix whose columns are the diameters.
    xx = first[:, 0] ** 2 + second[:, 0] ** 2
    yy = first[:, 1] ** 2 + second[:, 1] ** 2
    xy = first[:, 0] * first[:, 1] + second[:, 0] * second[:, 1]
    area = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    difference = 0.5 * (xx - yy)
    square = 0.5 * (xx + yy) + np.sqrt(difference**2 + xy**2)
    long = np.sqrt(square)
    wide = np.divide(area, long, out=np.zeros_like(long), where=long > 0)
    # Of two ways to the same axis, the one that takes no difference of equal numbers.
    flat = (difference >= 0)[:, None]
    axis = np.where(flat, np.stack([square - yy, xy], axis=1), np.stack([xy, square - xx], axis=1))
    length = np.sqrt(axis[:, 0] ** 2 + axis[:, 1] ** 2)
    scale = np.divide(long, length, out=np.zeros_like(long), where=length > 0)
    return axis * scale[:, None], long, wide


def _neighbours(
    middles: FloatArray, size: IntArray, width: FloatArray, wrap: NDArray[np.uint8]
) -> tuple[IntArray, IntArray, FloatArray]:
    """Give the texel that a square's middle lies in, the one beside it that is next, and its share."""
    place = middles * size
    near = np.floor(place)
    aside = place - near - 0.5
    share = np.clip(0.5 - (0.5 - np.abs(aside)) / width, 0.0, 0.5)
    texel = near.astype(np.int64)
    beside = texel + np.where(aside < 0.0, -1, 1)
    return _wrapped(texel, size, wrap), _wrapped(beside, size, wrap), share[:, None]


def _wrapped(places: IntArray, size: IntArray, wrap: NDArray[np.uint8]) -> IntArray:
    repeated = places % size
    if not wrap.any():
        return repeated
    around = places % (2 * size)
    mirrored = np.minimum(around, 2 * size - 1 - around)
    return np.choose(wrap, [repeated, np.clip(places, 0, size - 1), mirrored])


def _mixed(first: FloatArray, second: FloatArray, share: FloatArray) -> FloatArray:
    mixed = second - first
    mixed *= share
    mixed += first
    return mixed
