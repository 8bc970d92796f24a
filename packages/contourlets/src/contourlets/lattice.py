"""Pixel tables of the directional bank: lattices, polyphase components and borders.

The bank is a binary tree of two-channel ladders. Every sample of every channel belongs to a pixel of
the image, so the whole tree can be computed in place. Two tables of pixel indices describe a ladder
step: the pixels that the step replaces, and the rectangle of pixels, with borders, under its separable
filter. This module only computes the tables.

The sampling matrices are those of M. N. Do, "Directional multiresolution image representations"
(thesis, EPFL 2001), chapter 3, in the arrangement of his Contourlet Toolbox: quincunx matrices
Q1 = [1 −1; 1 1] and Q2 = [1 1; −1 1], then parallelogram matrices P1 = [2 0; 1 1], P2 = [2 0; −1 1]
in the first half of the tree and their transposes P3, P4 in the second.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby
from typing import Literal, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from .errors import ExtensionError, LevelsError
from .filters import LadderStep, ladder_steps

Extension = Literal["periodic", "circular", "symmetric"]
Indices = NDArray[np.intp]
_Part = TypeVar("_Part")

EXTENSIONS: tuple[Extension, ...] = get_args(Extension)
"""Names of the border extensions."""

MAX_DIRECTIONS_LOG2 = 5
"""The finest directional bank has 2^5 = 32 bands."""

_Q1 = np.array([[1, -1], [1, 1]])
_PARALLELOGRAMS = (np.array([[2, 0], [1, 1]]), np.array([[2, 0], [-1, 1]]))
_LADDER_NEIGHBOURS = (np.array([1, 1]), np.array([1, 0]))
_HAAR_NEIGHBOURS = (np.array([1, 1]), np.array([-1, 1]))


@dataclass(frozen=True, eq=False)
class Stage:
    """A ladder step of several channels at once, as flat indices of pixels.

    The step replaces the pixels `target` (n,). Its filter covers the pixels `source` (channels, rows +
    before + after, columns + before + after), in lattice coordinates. `keep` (n,) are the indices of the
    outputs for `target` among the `channels × rows × columns` outputs of the filter; None means all.
    """

    step: LadderStep
    target: Indices
    source: Indices
    keep: Indices | None


@dataclass(frozen=True, eq=False)
class DirectionalTables:
    """The whole directional bank of one image size: its stages in the order of analysis.

    `bands` are the flat indices of the pixels with the coefficients of each band, in band order.
    """

    stages: tuple[Stage, ...]
    bands: tuple[Indices, ...]


_Ladder = list[tuple[Indices, Indices, Indices | None]]
"""A split of a node: per ladder step `target`, `source` and `keep` of a `Stage` of one channel."""


def check_extension(extension: str) -> None:
    """Raise `ExtensionError` if no border extension has this name."""
    if extension not in EXTENSIONS:
        raise ExtensionError(
            f"No extension is called {extension!r}; the names are {', '.join(EXTENSIONS[:-1])} and "
            f"{EXTENSIONS[-1]}."
        )


def side_multiple(directions_log2: int) -> int:
    """Return the number whose multiples are allowed as sides of an image, for a bank of 2^l bands."""
    return max(2, 2 ** (directions_log2 - 1)) if directions_log2 else 1


def band_shapes(shape: tuple[int, int], directions_log2: int) -> tuple[tuple[int, int], ...]:
    """Return the shapes of the 2^l bands of an image, in band order."""
    rows, columns = shape
    if directions_log2 == 0:
        return ((rows, columns),)
    if directions_log2 == 1:
        return ((rows // 2, columns),) * 2
    half = 2 ** (directions_log2 - 1)
    return ((rows // half, columns // 2),) * half + ((rows // 2, columns // half),) * half


@lru_cache(maxsize=16)
def directional_tables(
    shape: tuple[int, int], directions_log2: int, filter_name: str, extension: Extension
) -> DirectionalTables:
    """Compute the tables of a directional bank of 2^l bands.

    `periodic` is the extension of the toolbox: the array of each channel, stored along sheared axes, is
    wrapped without correction (with half a turn at the first level). From the third level on, this is not
    the torus of the image: where a sheared axis wraps, neighbouring rows are not adjacent in the image.
    `circular` wraps on the true torus. `symmetric` reflects each node of the tree about its first and last
    row and column. This maps each polyphase component onto itself, so every ladder step stays invertible.
    """
    steps = ladder_steps(filter_name)
    pixels = np.arange(shape[0] * shape[1]).reshape(shape)
    if directions_log2 == 0:
        return DirectionalTables((), (pixels,))
    if extension == "periodic":
        levels, bands = _wrapped_tree(pixels, directions_log2, filter_name, steps)
    else:
        circular = extension == "circular"
        levels, bands = _tree_in_place(
            shape, directions_log2, filter_name, steps, circular=circular
        )
    stages = tuple(stage for level in levels for stage in _stack(level, steps))
    return DirectionalTables(stages, tuple(np.ascontiguousarray(band) for band in bands))


def check_directions(directions_log2: int) -> None:
    """Raise `LevelsError` unless l is an integer from 0 to 5."""
    is_integer = isinstance(directions_log2, (int, np.integer)) and not isinstance(
        directions_log2, bool
    )
    if not is_integer or not 0 <= directions_log2 <= MAX_DIRECTIONS_LOG2:
        raise LevelsError(
            f"A level has 2^l directions with an integer l from 0 to {MAX_DIRECTIONS_LOG2}, not "
            f"{directions_log2!r}."
        )


def _stack(ladders: list[_Ladder], steps: tuple[LadderStep, LadderStep]) -> Iterator[Stage]:
    """Yield one stage per step and shape of rectangles, from the ladders of a level of the tree."""

    def shapes(ladder: _Ladder) -> list[tuple[int, ...]]:
        return [source.shape for _, source, _ in ladder]

    for _, group in groupby(sorted(ladders, key=shapes), key=shapes):
        for step, parts in zip(steps, zip(*group, strict=True), strict=True):
            reach = step.before + step.after
            rows, columns = parts[0][1].shape
            area = (rows - reach) * (columns - reach)
            keeps = [keep + k * area for k, (_, _, keep) in enumerate(parts) if keep is not None]
            yield Stage(
                step,
                target=np.concatenate([target.ravel() for target, _, _ in parts]),
                source=np.stack([source for _, source, _ in parts]),
                keep=np.concatenate(keeps) if keeps else None,
            )


# The toolbox's arrays: polyphase components stored along sheared axes -----------------------------


def _shear(x: Indices, shift: int) -> Indices:
    """Resample by R3^shift: y[i, j] = x[i, j + shift i], with wrapped columns."""
    rows, columns = np.ogrid[: x.shape[0], : x.shape[1]]
    return x[rows, (columns + shift * rows) % x.shape[1]]


def _quincunx_components(x: Indices) -> tuple[Indices, Indices]:
    """Return the polyphase components of Q1 = R2 D1 R3; the second is a pixel to the right of the first."""
    y = _shear(x.T, -1).T
    return _shear(y[::2], 1), _shear(np.roll(y[1::2], -1, axis=1), 1)


def _parallelogram_components(x: Indices, kind: int) -> tuple[Indices, Indices]:
    """Return the polyphase components of P1 = D1 R3 (kind 0) or P2 = D1 R4 (kind 1)."""
    if kind == 0:
        return _shear(x[::2], 1), _shear(np.roll(x[1::2], -1, axis=1), 1)
    return _shear(x[::2], -1), _shear(x[1::2], -1)


def _haar_pairs(x: Indices, level: int, kind: int) -> tuple[Indices, Indices]:
    """Return the kept coset, and the neighbours for the two-tap filter."""
    # The toolbox's two taps lie along the rows at the first two levels (the second is transposed
    # here), and along the rows of the node resampled by R1 or R2 further down.
    if level > 2:
        x = _shear(x.T, 1 - 2 * kind).T
    turn = 1 if level > 2 and kind == 1 else -1
    neighbours = np.roll(x, -1, axis=0 if level == 2 else 1)
    kept, paired = (_shear(y.T, turn).T for y in (x, neighbours))
    return _shear(kept[::2], -turn), _shear(paired[::2], -turn)


def _wrap(x: Indices, step: LadderStep, *, half_turn: bool) -> Indices:
    """Extend an array by the reach of a step; with `half_turn`, a wrap of rows shifts columns by half."""
    rows, columns = (np.arange(-step.before, n + step.after)[:, None] for n in x.shape)
    turns = rows // x.shape[0] * (x.shape[1] // 2) if half_turn else 0
    return x[rows % x.shape[0], (columns.T + turns) % x.shape[1]]


def _components(node: Indices, level: int, kind: int, filter_name: str) -> tuple[Indices, Indices]:
    if filter_name == "haar":
        return _haar_pairs(node, level, kind)
    if level > 2:
        return _parallelogram_components(node, kind)
    return _quincunx_components(node)


def in_order(
    parts: tuple[_Part, _Part], level: int, kind: int, filter_name: str
) -> tuple[_Part, _Part]:
    """Return the two channels of a split in the order of the toolbox."""
    haar = filter_name == "haar"
    straight = (level > 2 and kind == 0) if haar else level == 1
    return parts if straight else (parts[1], parts[0])


def _wrapped_tree(
    pixels: Indices, depth: int, filter_name: str, steps: tuple[LadderStep, LadderStep]
) -> tuple[list[list[_Ladder]], list[Indices]]:
    """Return ladders per level down to `depth`, and bands, in the arrays of the toolbox."""
    # The second level works on transposed nodes, as Q2 is Q1 with exchanged axes; the second half of
    # the tree stays transposed, as P3 and P4 are P1 and P2 with exchanged axes.
    nodes, levels = [pixels], []
    children: list[Indices]
    for level in range(1, depth + 1):
        nodes = [node.T for node in nodes] if level == 2 else nodes
        ladders, children = [], []
        half_turn = level == 1 and filter_name != "haar"
        for number, node in enumerate(nodes):
            parts = _components(node, level, number % 2, filter_name)
            ladder: _Ladder = []
            for step in steps:
                source = _wrap(parts[1 - step.target], step, half_turn=half_turn)
                ladder.append((parts[step.target], source, None))
            ladders.append(ladder)
            children += in_order(parts, level, number % 2, filter_name)
        half = len(children) // 2
        nodes = [n.T for n in children[:half]] + children[half:] if level == 2 else children
        levels.append(ladders)
    return levels, _back_sampled(nodes, depth)


def _back_sampled(nodes: list[Indices], depth: int) -> list[Indices]:
    """Undo the remaining shear, so that bands are sampled along rows and columns, and order the bands."""
    if depth == 1:
        return [_unquincunx(node) for node in nodes]
    half = len(nodes) // 2
    if depth > 2:
        shifts = [2 * (k // 2 + 1) - (half // 2 + 1) for k in range(half)] * 2
        nodes = [_shear(node, shift) for node, shift in zip(nodes, shifts, strict=True)]
    return nodes[:half] + [node.T for node in nodes[half:]][::-1]


def _unquincunx(node: Indices) -> Indices:
    node = _shear(node, -1)
    node[:, ::2] = _shear(node[:, ::2].T, 1).T
    node[:, 1::2] = _shear(node[:, 1::2].T, 1).T
    return node


# Pixels at their true positions: for the torus and for reflection ---------------------------------


def _tree_in_place(
    shape: tuple[int, int],
    depth: int,
    filter_name: str,
    steps: tuple[LadderStep, LadderStep],
    *,
    circular: bool,
) -> tuple[list[list[_Ladder]], list[Indices]]:
    """Return ladders per level down to `depth`, and bands, with every sample at its true pixel."""
    # A node is its sampling matrix and the position of its sample 0, which may be outside the image
    # because of the delays of the toolbox. In the second half of the tree, both have exchanged axes.
    nodes = [(np.eye(2, dtype=np.intp), np.zeros(2, dtype=np.intp))]
    levels = []
    children: list[tuple[Indices, Indices]]
    for level in range(1, depth + 1):
        ladders, children = [], []
        for number, (parent, anchor) in enumerate(nodes):
            kind, turned = number % 2, level > 2 and number >= len(nodes) // 2
            size = np.array(shape[::-1] if turned else shape)
            flat = np.array([1, shape[1]] if turned else [shape[1], 1])
            matrix, neighbour = ladder_geometry(parent, level, kind, haar=filter_name == "haar")
            anchors = (anchor, anchor + neighbour)
            ladder: _Ladder = []
            for step in steps:
                target = _coset(anchors[step.target], level, size)
                towards = neighbour if step.target == 0 else -neighbour
                source, keep = _rectangle(target, target[0] + towards, matrix, step)
                if circular:
                    source %= size
                else:
                    source = _reflect(source, anchor, _spacing(level - 1), size)
                ladder.append((target @ flat, source @ flat, keep))
            ladders.append(ladder)
            first, second = ((matrix, each) for each in anchors)
            children += in_order((first, second), level, kind, filter_name)
        if level == 2:
            children[2:] = [(m[::-1, ::-1], a[::-1]) for m, a in children[2:]]
        nodes = children
        levels.append(ladders)
    return levels, _bands_in_place([anchor for _, anchor in nodes], shape, depth, circular=circular)


def _spacing(level: int) -> Indices:
    """Return rows and columns between neighbouring samples of a channel at a level of the tree."""
    return np.array([1, 1] if level < 2 else [2 ** (level - 1), 2])


def _coset(anchor: Indices, level: int, size: Indices) -> Indices:
    """Return the positions (n, 2) of the samples of a channel within an image, in raster order."""
    spacing = _spacing(level)
    axes = [np.arange(*along) for along in zip(anchor % spacing, size, spacing, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    return grid[(grid - anchor).sum(axis=1) % 2 == 0] if level == 1 else grid


def _rectangle(
    target: Indices, displaced: Indices, matrix: Indices, step: LadderStep
) -> tuple[Indices, Indices]:
    """Return the positions that the filter of a step covers, and the indices of the outputs for the target."""
    cells: Indices = np.rint((target - target[0]) @ np.linalg.inv(matrix).T).astype(np.intp)
    low, high = cells.min(axis=0), cells.max(axis=0) + 1
    axes = [np.arange(a - step.before, b + step.after) for a, b in zip(low, high, strict=True)]
    rectangle: Indices = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    keep = (cells - low) @ np.array([high[1] - low[1], 1])
    return displaced + rectangle @ matrix.T, keep


def _reflect(positions: Indices, anchor: Indices, spacing: Indices, size: Indices) -> Indices:
    """Reflect about the first and the last samples within an image, repeatedly if needed."""
    origin, last = anchor % spacing, size // spacing - 1
    folded = (positions - origin) // spacing % np.maximum(2 * last, 1)
    return origin + spacing * np.minimum(folded, 2 * last - folded)


def _bands_in_place(
    anchors: list[Indices], shape: tuple[int, int], depth: int, *, circular: bool
) -> list[Indices]:
    """Return bands that start at their anchor on the torus, as in the toolbox, or at their first pixel."""
    half, spacing = len(anchors) // 2, _spacing(depth)
    bands = []
    for index, size in enumerate(band_shapes(shape, depth)):
        i, j = np.indices(size)
        if depth == 1:
            after = anchors[index][1]
            row, column = (2 * i - j % 2, j + after) if circular else (2 * i + (j + after) % 2, j)
        else:
            # The second half of the bands has exchanged axes and reverse order.
            turned = index >= half
            anchor = anchors[3 * half - 1 - index if turned else index]
            start = anchor if circular else anchor % spacing
            first, second = (j, i) if turned else (i, j)
            positions = (start[0] + spacing[0] * first, start[1] + spacing[1] * second)
            row, column = positions[::-1] if turned else positions
        bands.append(row % shape[0] * shape[1] + column % shape[1])
    return bands


def ladder_geometry(
    parent: Indices, level: int, kind: int, *, haar: bool
) -> tuple[Indices, Indices]:
    """Return the lattice of the two channels of a split, in pixels.

    `parent` (2, 2) is the sampling matrix of the node that is split, with exchanged axes in the second half
    of the tree. `level` is the level of the tree, from 1. `kind` is 0 for P1 and 1 for P2; the first two
    levels ignore it. Returns the sampling matrix (2, 2) of both channels, and the step (2,) from a sample
    of the first channel to its partner in the second channel.
    """
    if level == 1:
        return _Q1, np.array([0, 1])
    if level == 2:
        return 2 * np.eye(2, dtype=np.intp), parent @ np.array([0, 1] if haar else [1, 0])
    neighbours = _HAAR_NEIGHBOURS if haar else _LADDER_NEIGHBOURS
    return parent @ _PARALLELOGRAMS[kind], parent @ neighbours[kind]
