"""Layouts: where the taxels of a tactile pad are, and where each taxel looks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.base.arrays import FloatArray, IntArray, masked_fault
from visuohaptic.base.errors import ParameterError
from visuohaptic.base.units import UNITS

MOST_TAXELS = 100_000
"""Limit of taxels in a layout of arrays or of a file."""

OUTLINE_POINTS = 128
"""Points on the outline of a flat pad."""

_CORNERS_OF_ROUND = 32
_NEIGHBOURS = 6
# Neighbours on opposite sides of a taxel enclose at least 150 degrees.
_OPPOSITE = -0.866
_LARGEST = 1e100
_NO_TRIPLES: IntArray = np.zeros((3, 0), dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Layout:
    """Positions and directions of the t taxels of a pad, in the pad's frame.

    In the pad's frame x is along the columns of an imprint, y against its rows, and z away from the object, so a flat
    pad has z = 0 and looks along -z. The unit of length is half the pad's width: a pad of the size s (object radii)
    has its taxels at ``0.5 * s * positions``.

    Attributes
    ----------
    name : str
        Name in messages and pictures.
    positions, directions : ndarray of shape (t, 3)
        Position of each taxel, half widths, and the unit direction in which the taxel looks.
    shape : tuple of int
        ``(rows, columns)`` of a grid; ``(t,)`` of all other layouts. Imprints of a grid are images.
    counts : tuple of float
        Taxels along the rows' axis and along the columns' axis of the pad's square: 2 over their spacing.
    extents : tuple of float
        Half the width and half the height of the pad's outline, half widths; the larger number is 1.
    is_round : bool
        Whether the outline is an ellipse, or a rectangle.
    triples : ndarray of shape (3, k), int64
        A taxel, and two neighbours on opposite sides of the taxel; none in a grid, in which indices say the neighbours.
    half_width_m : float, optional
        Half the pad's width, metres. None if the lengths have no unit.
    """

    name: str
    positions: FloatArray
    directions: FloatArray
    shape: tuple[int, ...]
    counts: tuple[float, float]
    extents: tuple[float, float]
    is_round: bool
    triples: IntArray
    half_width_m: float | None = None

    @staticmethod
    def of(
        positions: ArrayLike,
        directions: ArrayLike,
        unit: str | None = None,
        name: str = "own",
        half_width: float | None = None,
    ) -> Layout:
        """Return a layout of given taxels.

        Parameters
        ----------
        positions : array_like
            Shape (t, 3): the taxels in the pad's frame. x is along the columns of an imprint, y against its rows, z away
            from the object. The pad's origin is the point that touches.
        directions : array_like
            Shape (t, 3): the directions in which the taxels look, of any length above 0: (0, 0, -1) for a flat pad.
        unit : {"mm", "cm", "m", "in"}, optional
            Unit of the positions. Without a unit only their proportions are known, and `press` needs a size.
        name : str
            Name in messages.
        half_width : float, optional
            Half the width of the pad, in the unit of the positions: a square or a disc of this size around the origin is the
            pad's outline. By default the outermost taxels are on the outline.

        Returns
        -------
        Layout

        Raises
        ------
        ParameterError
            If positions or directions have another shape, are not finite, or too many; if a direction has the length 0
            or points away from the object; if two taxels are at one position, or all on the pad's axis, or a taxel is
            beyond the half width.
        """
        points = _rows(positions, "positions", name)
        looks = _unit_directions(_rows(directions, "directions", name), len(points), name)
        if unit is not None and unit not in UNITS:
            raise ParameterError(
                f"Layout {name}: unit is {unit!r}; {', '.join(UNITS)} are allowed."
            )
        farthest = float(np.abs(points[:, :2]).max())
        half = farthest if half_width is None else float(half_width)
        if not farthest > 0:
            raise ParameterError(
                f"Layout {name} has all taxels on the pad's axis (x and y are 0); a width is needed."
            )
        if not farthest <= half < _LARGEST:
            raise ParameterError(
                f"Layout {name}: half_width is {half:g}, and a taxel is {farthest:g} from the axis; at least as much is needed."
            )
        extents = None if half_width is None else (1.0, 1.0)
        metres = None if unit is None else UNITS[unit] * half
        return build_layout(name, points / half, looks, metres, extents)

    def __repr__(self) -> str:
        wide = "" if self.half_width_m is None else f", {2000 * self.half_width_m:g} mm wide"
        return f"<Layout {self.name}: {len(self)} taxels{wide}>"

    def __len__(self) -> int:
        return len(self.positions)

    @cached_property
    def is_flat(self) -> bool:
        """Whether all taxels are in the plane z = 0 and look along the pad's axis."""
        return not self.positions[:, 2].any() and bool((self.directions == (0, 0, -1)).all())

    @cached_property
    def coordinates(self) -> tuple[tuple[FloatArray, FloatArray], ...]:
        """Position and direction along columns, rows and the normal, each of a shape that broadcasts to `shape`.

        A dimension of `shape` along which all values are equal has length 1: rows of a grid have one position along the
        columns of the grid, and a flat pad one direction.
        """
        signs = (1.0, -1.0, 1.0)
        parts = [
            (sign * self.positions[:, axis], sign * self.directions[:, axis])
            for axis, sign in enumerate(signs)
        ]
        return tuple(
            (_shortest(place.reshape(self.shape)), _shortest(look.reshape(self.shape)))
            for place, look in parts
        )

    @cached_property
    def norms(self) -> FloatArray:
        """Share (t,) of the pad's size at which the outline crosses each taxel, seen along the axis.

        The share is at most 1 minus a quarter of a spacing, so that a pad that shrinks below a taxel shrinks noticeably.
        """
        across, along = np.abs(self.positions[:, :2] / self.extents).T
        norms = np.hypot(across, along) if self.is_round else np.maximum(along, across)
        return np.minimum(norms, 1 - 0.5 / max(self.counts))

    @cached_property
    def lowest(self) -> float:
        """Depth of the lowest taxel below the pad's origin, half widths, at most 0."""
        return min(float(self.positions[:, 2].min()), 0.0)

    @cached_property
    def outline(self) -> FloatArray:
        """Points (k, 2) on the outline of a flat pad, along columns and rows, half widths; none for other pads."""
        if not self.is_flat:
            return np.zeros((0, 2))
        outline = _circle(OUTLINE_POINTS) if self.is_round else _square()
        return outline * self.extents

    @cached_property
    def corners(self) -> FloatArray:
        """Corners (k, 2) of the outline as a polygon, along columns and rows, half widths."""
        square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
        corners = _circle(_CORNERS_OF_ROUND) if self.is_round else square
        return corners * self.extents

    @cached_property
    def body(self) -> float:
        """Depth of the pad behind its taxels, half widths: the smallest radius at which neighbours bulge outwards.

        A ray that starts farther behind a taxel starts beyond the pad. Flat and hollow pads have no limit (infinity).
        """
        if self.is_flat:
            return np.inf
        first, second = self.pairs.T
        apart = self.positions[first] - self.positions[second]
        turned = self.directions[first] - self.directions[second]
        bulges = (apart * turned).sum(axis=1) > 1e-9
        radii = np.linalg.norm(apart[bulges], axis=1) / np.linalg.norm(turned[bulges], axis=1)
        return float(radii.min(initial=np.inf))

    @cached_property
    def pairs(self) -> IntArray:
        """Pairs (k, 2) of neighbouring taxels, each pair once."""
        near = _nearest(self.positions)
        pairs = np.column_stack([np.repeat(np.arange(len(self)), near.shape[1]), near.ravel()])
        return np.unique(np.sort(pairs, axis=1), axis=0)

    @cached_property
    def approach(self) -> Layout:
        """The points that the approach checks, all looking along the axis; a flat pad is its own.

        Other pads check their taxels and a point between each two neighbours. The point between is the middle of a cubic
        whose ends are perpendicular to the directions (A. Vlachos et al., Curved PN Triangles, 2001).
        """
        if self.is_flat:
            return self
        first, second = self.pairs.T
        apart = self.positions[second] - self.positions[first]
        sags = [
            (sign * apart * self.directions[end]).sum(axis=1)[:, None] * self.directions[end]
            for sign, end in ((1, first), (-1, second))
        ]
        between = (self.positions[first] + self.positions[second]) / 2 - (sags[0] + sags[1]) / 8
        points = np.concatenate([self.positions, between])
        axial = np.tile([0.0, 0.0, -1.0], (len(points), 1))
        return Layout(
            self.name,
            points,
            axial,
            (len(points),),
            self.counts,
            self.extents,
            self.is_round,
            _NO_TRIPLES,
        )

    @cached_property
    def chart(self) -> FloatArray:
        """Positions (t, 2) in a drawing of the pad, x to the right and y upwards, half widths.

        A taxel that lies z behind the foremost taxel is drawn z farther from the axis, along the line in which the taxel
        looks, as if the pad were unrolled.
        """
        flat, behind = self.positions[:, :2], self.positions[:, 2] - self.positions[:, 2].min()
        aside = self.directions[:, :2]
        lengths = np.hypot(*aside.T)
        outwards = np.where((aside * flat).sum(axis=1) < 0, -1.0, 1.0)
        shifts = np.divide(
            behind * outwards, lengths, out=np.zeros_like(lengths), where=lengths > 1e-9
        )
        return flat + shifts[:, None] * aside


def build_layout(
    name: str,
    positions: FloatArray,
    directions: FloatArray,
    half_width_m: float | None = None,
    extents: tuple[float, float] | None = None,
) -> Layout:
    """Return a layout of checked taxels; `positions` are in half widths, `directions` have length 1.

    By default the outermost taxels are on the outline, and extents below 0.1, as of a row of taxels, become 0.1. The
    outline is an ellipse if the ellipse holds all taxels, otherwise a rectangle.
    """
    if extents is None:
        across, along = np.maximum(np.abs(positions[:, :2]).max(axis=0), 0.1)
        extents = (float(across), float(along))
    is_round = bool((np.hypot(*(positions[:, :2] / extents).T) < 1 + 1e-6).all())
    near = _nearest(positions)
    apart = positions[near] - positions[:, None] if near.size else np.zeros((len(positions), 0, 3))
    distances = np.linalg.norm(apart, axis=2)
    spacing = float(np.median(distances.min(axis=1))) if near.size else 2.0
    counts = (2 / spacing, 2 / spacing)
    triples = _triples(near, apart, distances)
    shape = (len(positions),)
    return Layout(
        name, positions, directions, shape, counts, extents, is_round, triples, half_width_m
    )


@lru_cache(maxsize=64)
def grid_layout(rows: int, columns: int) -> Layout:
    """Return the layout of a flat grid: the centres of equal cells, row by row, which look along the axis.

    A rectangle has other lengths along its rows and columns; the edges of `cast_heights` say both.
    """
    down, aside = np.meshgrid(sensing_offsets(rows), sensing_offsets(columns), indexing="ij")
    positions = np.stack([aside, -down, np.zeros_like(down)], axis=-1).reshape(-1, 3)
    directions = np.tile([0.0, 0.0, -1.0], (rows * columns, 1))
    return Layout(
        "square", positions, directions, (rows, columns), (rows, columns), (1.0, 1.0),
        is_round=False, triples=_NO_TRIPLES,
    )  # fmt: skip


def sensing_offsets(count: int) -> FloatArray:
    """Return the sensing points (count,) along an axis of the square, the centres of equal cells, in half edges."""
    return (2 * np.arange(count) + 1 - count) / count


def _rows(values: ArrayLike, what: str, name: str) -> FloatArray:
    """Return taxels as an array (t, 3). Raise `ParameterError` for other shapes and numbers."""
    if fault := masked_fault(values):
        raise ParameterError(f"Layout {name}: {what} has {fault}.")
    try:
        rows = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ParameterError(f"Layout {name}: {what} holds no numbers.") from error
    if rows.ndim != 2 or rows.shape[1] != 3 or not len(rows):
        raise ParameterError(
            f"Layout {name}: {what} has the shape {rows.shape}; (taxels, 3) is needed."
        )
    if len(rows) > MOST_TAXELS:
        raise ParameterError(
            f"Layout {name} has {len(rows):,} taxels; at most {MOST_TAXELS:,} are allowed."
        )
    broken = np.flatnonzero(~(np.abs(rows) < _LARGEST).all(axis=1))
    if len(broken):
        raise ParameterError(
            f"Layout {name}: {what} has NaN, infinity or numbers beyond {_LARGEST:g}, the first in taxel {broken[0]}."
        )
    if what == "positions":
        _, firsts, counts = np.unique(rows, axis=0, return_index=True, return_counts=True)
        if len(firsts) < len(rows):
            first = int(firsts[counts > 1].min())
            second = int(np.flatnonzero((rows == rows[first]).all(axis=1))[1])
            raise ParameterError(
                f"Layout {name}: taxels {first} and {second} are both at {rows[first].tolist()}; each taxel needs its own position."
            )
    return rows


def _unit_directions(directions: FloatArray, count: int, name: str) -> FloatArray:
    """Return unit directions. Raise `ParameterError` for directions without a length, or away from the object."""
    if len(directions) != count:
        raise ParameterError(
            f"Layout {name} has {count} positions and {len(directions)} directions; as many are needed."
        )
    largest = np.abs(directions).max(axis=1, keepdims=True)
    zero = np.flatnonzero(largest == 0)
    if len(zero):
        raise ParameterError(
            f"Layout {name}: taxel {zero[0]} has the direction (0, 0, 0); a direction of any length above 0 is needed."
        )
    # Divided by the largest component first, so that squares of short directions are not 0.
    scaled = directions / largest
    units: FloatArray = scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
    behind = np.flatnonzero(units[:, 2] > 1e-9)
    if len(behind):
        raise ParameterError(
            f"Layout {name}: taxel {behind[0]} looks behind the pad, along {directions[behind[0]].tolist()}; z is away from the "
            "object, so the z of a direction is at most 0."
        )
    return units


def _shortest(values: FloatArray) -> FloatArray:
    """Return values with one index of each dimension along which all are equal."""
    for axis in range(values.ndim):
        first = values.take([0], axis=axis)
        values = first if (values == first).all() else values
    return values


def _nearest(positions: FloatArray) -> IntArray:
    """Return the indices (t, k) of the nearest other taxels; k is at most 6."""
    # Imported here, because the square needs no search.
    from scipy.spatial import cKDTree

    count = min(_NEIGHBOURS, len(positions) - 1)
    if not count:
        return np.zeros((len(positions), 0), dtype=np.int64)
    _, near = cKDTree(positions).query(positions, k=count + 1)
    near = np.asarray(near, dtype=np.int64)
    # A taxel is its own nearest neighbour, because no two are at one position.
    return near[:, 1:]


def _triples(near: IntArray, apart: FloatArray, distances: FloatArray) -> IntArray:
    """Return (3, k): each taxel with pairs of its neighbours on opposite sides."""
    units = apart / distances[..., None]
    first, second = np.triu_indices(near.shape[1], 1)
    opposite = np.einsum("tki,tki->tk", units[:, first], units[:, second]) < _OPPOSITE
    taxels, pairs = np.nonzero(opposite)
    return np.stack([taxels, near[taxels, first[pairs]], near[taxels, second[pairs]]])


def _circle(count: int) -> FloatArray:
    angles = 2 * np.pi * np.arange(count) / count
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _square() -> FloatArray:
    """Return points at equal steps along the square, the corners among them, from the first corner of the imprint."""
    side = OUTLINE_POINTS // 4
    along = -1 + 2 * np.arange(side) / side
    edge = np.ones(side)
    return np.concatenate(
        [
            np.column_stack([along, -edge]),
            np.column_stack([edge, along]),
            np.column_stack([-along, edge]),
            np.column_stack([-edge, -along]),
        ]
    )


def nearest_taxels(layout: Layout, pixels: int) -> tuple[IntArray, NDArray[np.bool_]]:
    """Return the taxel that each pixel of a square drawing shows, and the pixels that show none, (p, p) each.

    A pixel shows the nearest taxel of the chart, if the taxel is nearer than one spacing of taxels.
    """
    from scipy.spatial import cKDTree

    centres = sensing_offsets(pixels) * max(1.0, float(np.abs(layout.chart).max()))
    down, aside = np.meshgrid(centres, centres, indexing="ij")
    distances, index = cKDTree(layout.chart).query(np.stack([aside, -down], axis=-1))
    return np.asarray(index, dtype=np.int64), distances > 2 / layout.counts[0]
