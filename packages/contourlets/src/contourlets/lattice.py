"""Pixel tables of the directional bank: lattices, polyphase components and borders.

The bank is a binary tree of two-channel ladders. Every sample of every channel sits at a pixel of
the image, so the whole tree can be computed in place. Two tables of pixel numbers describe a ladder
step: the pixels that it replaces, and the rectangle of pixels, borders included, that its separable
filter covers. This module makes the tables; it handles no images.

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
    """A ladder step of several channels at once, by flat numbers of pixels.

    It replaces `target` (n,); its filter covers `source` (channels, rows + before + after, columns
    + before + after), in lattice coordinates. `keep` (n,) are those of the filter's `channels ×
    rows × columns` outputs that belong to `target`, in this order; None means all.
    """

    step: LadderStep
    target: Indices
    source: Indices
    keep: Indices | None


@dataclass(frozen=True, eq=False)
class DirectionalTables:
    """The whole directional bank of one image size: its stages in the order of analysis.

    `bands` are the flat numbers of the pixels at which each band's coefficients sit, in band order.
    """

    stages: tuple[Stage, ...]
    bands: tuple[Indices, ...]


@dataclass(frozen=True, eq=False)
class _Split:
    """One two-channel ladder: pixels of its components, and of each step's source with borders."""

    targets: tuple[Indices, Indices]
    sources: tuple[Indices, Indices]
    keeps: tuple[Indices | None, Indices | None]


def check_extension(extension: str) -> None:
    """Raise `ExtensionError` if there is no border extension of that name."""
    if extension not in EXTENSIONS:
        raise ExtensionError(
            f"No extension is called {extension!r}; the names are {', '.join(EXTENSIONS[:-1])} and "
            f"{EXTENSIONS[-1]}."
        )


def side_multiple(directions_log2: int) -> int:
    """Give the number that an image's sides must be multiples of for a bank of 2^l bands."""
    if directions_log2 == 0:
        return 1
    return max(2, 2 ** (directions_log2 - 1))


def band_shapes(shape: tuple[int, int], directions_log2: int) -> tuple[tuple[int, int], ...]:
    """Shapes of the 2^l bands of an image, in band order."""
    rows, columns = shape
    if directions_log2 == 0:
        return ((rows, columns),)
    if directions_log2 == 1:
        return ((rows // 2, columns),) * 2
    coarse, half = 2 ** (directions_log2 - 1), 2 ** (directions_log2 - 1)
    flat, tall = (rows // coarse, columns // 2), (rows // 2, columns // coarse)
    return (flat,) * half + (tall,) * half


@lru_cache(maxsize=16)
def directional_tables(
    shape: tuple[int, int], directions_log2: int, filter_name: str, extension: Extension
) -> DirectionalTables:
    """Make the tables of a directional bank of 2^l bands.

    `periodic` is the toolbox's extension: each channel's array, stored along sheared axes, is
    wrapped without correction (with half a turn at the first level). From the third level on this
    is not the torus of the image: where a sheared axis wraps, rows become neighbours that are not
    adjacent in the image. `circular` wraps on the true torus. `symmetric` reflects each node of the
    tree about its first and last row and column, which maps each polyphase component onto itself,
    so that every ladder step stays invertible.

    Raises `LevelsError` when l is not allowed, or the sides are no multiples of `side_multiple`.
    """
    check_directions(directions_log2)
    steps = ladder_steps(filter_name)
    multiple = side_multiple(directions_log2)
    if min(shape) < multiple or shape[0] % multiple or shape[1] % multiple:
        raise LevelsError(
            f"A directional bank of 2^{directions_log2} bands needs sides that are multiples of "
            f"{multiple}, not {shape[0]} × {shape[1]}."
        )
    pixels = np.arange(shape[0] * shape[1]).reshape(shape)
    if directions_log2 == 0:
        return DirectionalTables((), (pixels,))
    if extension == "periodic":
        levels, bands = _wrapped_tree(pixels, directions_log2, filter_name, steps)
    else:
        levels, bands = _placed_tree(shape, directions_log2, filter_name, steps, extension)
    stages = tuple(stage for level in levels for stage in _stack(level, steps))
    return DirectionalTables(stages, tuple(np.ascontiguousarray(band) for band in bands))


def check_directions(directions_log2: int) -> None:
    """Raise `LevelsError` unless l is an integer from 0 to 5."""
    whole = isinstance(directions_log2, (int, np.integer)) and not isinstance(directions_log2, bool)
    if not whole or not 0 <= directions_log2 <= MAX_DIRECTIONS_LOG2:
        raise LevelsError(
            f"A level has 2^l directions with an integer l from 0 to {MAX_DIRECTIONS_LOG2}, not "
            f"{directions_log2!r}."
        )


def _stack(splits: list[_Split], steps: tuple[LadderStep, LadderStep]) -> Iterator[Stage]:
    """Join the splits of one tree level that have rectangles of one shape: one stage per step."""

    def shapes(split: _Split) -> tuple[tuple[int, ...], ...]:
        return tuple(source.shape for source in split.sources)

    for _, members in groupby(sorted(splits, key=shapes), key=shapes):
        group = list(members)
        for number, step in enumerate(steps):
            source = np.stack([split.sources[number] for split in group])
            target = np.concatenate([split.targets[number].ravel() for split in group])
            yield Stage(step, target, source, _stack_keeps(group, number, source.shape, step))


def _stack_keeps(
    group: list[_Split], number: int, shape: tuple[int, ...], step: LadderStep
) -> Indices | None:
    reach = step.before + step.after
    area = (shape[1] - reach) * (shape[2] - reach)
    keeps = [split.keeps[number] for split in group]
    if keeps[0] is None:
        return None
    return np.concatenate([keep + k * area for k, keep in enumerate(keeps) if keep is not None])


# The toolbox's arrays: polyphase components stored along sheared axes -----------------------------


def _shear(x: Indices, shift: int) -> Indices:
    """Resample by R3^shift: y[i, j] = x[i, j + shift i], columns wrapping."""
    rows, columns = np.ogrid[: x.shape[0], : x.shape[1]]
    return x[rows, (columns + shift * rows) % x.shape[1]]


def _quincunx_components(x: Indices) -> tuple[Indices, Indices]:
    """Polyphase components of Q1 = R2 D1 R3, the second one pixel to the right of the first."""
    y = _shear(x.T, -1).T
    return _shear(y[::2], 1), _shear(np.roll(y[1::2], -1, axis=1), 1)


def _parallelogram_components(x: Indices, kind: int) -> tuple[Indices, Indices]:
    """Polyphase components of P1 = D1 R3 (kind 0) or P2 = D1 R4 (kind 1)."""
    if kind == 0:
        return _shear(x[::2], 1), _shear(np.roll(x[1::2], -1, axis=1), 1)
    return _shear(x[::2], -1), _shear(x[1::2], -1)


def _haar_pairs(x: Indices, level: int, kind: int) -> tuple[Indices, Indices]:
    """Give the kept coset and the neighbours that the two-tap filter combines it with."""
    # The toolbox's two taps lie along the rows at the first two levels (the second is transposed
    # here), and along the rows of the node resampled by R1 or R2 further down.
    if level > 2:
        x = _shear(x.T, 1 - 2 * kind).T
    turn = 1 if level > 2 and kind == 1 else -1
    neighbours = np.roll(x, -1, axis=0 if level == 2 else 1)
    kept, paired = (_shear(y.T, turn).T for y in (x, neighbours))
    return _shear(kept[::2], -turn), _shear(paired[::2], -turn)


def _wrap(x: Indices, step: LadderStep, *, half_turn: bool) -> Indices:
    """Extend an array by a step's reach; with `half_turn`, a wrap of rows shifts columns by half."""
    rows, columns = (np.arange(-step.before, n + step.after)[:, None] for n in x.shape)
    turns = rows // x.shape[0] * (x.shape[1] // 2) if half_turn else 0
    return x[rows % x.shape[0], (columns.T + turns) % x.shape[1]]


def _wrapped_split(
    parts: tuple[Indices, Indices], steps: tuple[LadderStep, LadderStep], *, half_turn: bool
) -> _Split:
    first, second = (_wrap(parts[1 - step.target], step, half_turn=half_turn) for step in steps)
    return _Split((parts[steps[0].target], parts[steps[1].target]), (first, second), (None, None))


def _components(node: Indices, level: int, kind: int, filter_name: str) -> tuple[Indices, Indices]:
    if filter_name == "haar":
        return _haar_pairs(node, level, kind)
    if level > 2:
        return _parallelogram_components(node, kind)
    return _quincunx_components(node)


def in_order(
    parts: tuple[_Part, _Part], level: int, kind: int, filter_name: str
) -> tuple[_Part, _Part]:
    """Put the two channels of a split into the toolbox's order."""
    haar = filter_name == "haar"
    straight = (level > 2 and kind == 0) if haar else level == 1
    return parts if straight else (parts[1], parts[0])


def _wrapped_tree(
    pixels: Indices, depth: int, filter_name: str, steps: tuple[LadderStep, LadderStep]
) -> tuple[list[list[_Split]], list[Indices]]:
    """Split down to `depth` in the toolbox's arrays."""
    # The second level works on transposed nodes, as Q2 is Q1 with exchanged axes; the second half of
    # the tree stays transposed, as P3 and P4 are P1 and P2 with exchanged axes.
    nodes, levels = [pixels], []
    children: list[Indices]
    for level in range(1, depth + 1):
        nodes = [node.T for node in nodes] if level == 2 else nodes
        splits, children = [], []
        for number, node in enumerate(nodes):
            parts = _components(node, level, number % 2, filter_name)
            splits.append(
                _wrapped_split(parts, steps, half_turn=level == 1 and filter_name != "haar")
            )
            children += in_order(parts, level, number % 2, filter_name)
        half = len(children) // 2
        nodes = [n.T for n in children[:half]] + children[half:] if level == 2 else children
        levels.append(splits)
    return levels, _back_sampled(nodes, depth)


def _back_sampled(nodes: list[Indices], depth: int) -> list[Indices]:
    """Undo the remaining shear, so that bands are sampled along rows and columns; order them."""
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


@dataclass(frozen=True, eq=False)
class _Node:
    """A channel of the tree: its samples' positions, sampling matrix, and the position of sample 0."""

    # The anchor may lie outside the image, because of the toolbox's delays.
    positions: Indices
    matrix: Indices
    anchor: Indices
    spacing: Indices


def _reflect(index: Indices, size: Indices | int) -> Indices:
    """Reflect about the first and the last of `size` samples, repeatedly if needed."""
    period = np.maximum(2 * (np.asarray(size) - 1), 1)
    folded = index % period
    return np.where(np.asarray(size) == 1, 0, np.minimum(folded, period - folded))


def _placed_tree(
    shape: tuple[int, int],
    depth: int,
    filter_name: str,
    steps: tuple[LadderStep, LadderStep],
    extension: Extension,
) -> tuple[list[list[_Split]], list[Indices]]:
    """Split down to `depth`, every sample at its own pixel, in raster order."""
    haar = filter_name == "haar"
    origin, spacing = np.array([0, 0]), np.array([1, 1])
    whole = _grid(shape, origin, spacing)
    nodes = [_Node(whole, np.eye(2, dtype=np.intp), origin, spacing)]
    levels = []
    children: list[_Node]
    for level in range(1, depth + 1):
        splits, children = [], []
        half = len(nodes) // 2
        for number, node in enumerate(nodes):
            turned = level > 2 and number >= half
            size = np.array(shape[::-1] if turned else shape)
            pair, matrix, neighbour = _divide(node, level, number % 2, size, haar=haar)
            fold = _folding(node, size, by_node=level > 2, extension=extension)
            splits.append(
                _placed_split(pair, matrix, neighbour, steps, fold, int(size[1]), turned=turned)
            )
            children += in_order(pair, level, number % 2, filter_name)
        if level == 2:
            children[2:] = [_turned(child) for child in children[2:]]
        nodes = children
        levels.append(splits)
    if extension == "circular":
        return levels, _anchored_bands(nodes, shape, depth)
    return levels, _raster_bands(nodes, shape, depth)


def _grid(shape: tuple[int, int], origin: Indices, spacing: Indices) -> Indices:
    """Positions (n, 2) of a rectangular grid within an image, in raster order."""
    axes = [np.arange(o, n, s) for o, n, s in zip(origin, shape, spacing, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


def ladder_geometry(
    parent: Indices, level: int, kind: int, *, haar: bool
) -> tuple[Indices, Indices]:
    """Give the lattice of the two channels of a split at a level of the tree, 1 for the first; in pixels.

    `parent` (2, 2) is the sampling matrix of the node that is split, with exchanged axes in the
    second half of the tree; `kind` is 0 for P1, 1 for P2, and not used at the first two levels.
    Gives the sampling matrix (2, 2) of both channels, and the step (2,) from a sample of the first
    channel to its partner in the second.
    """
    if level == 1:
        return _Q1, np.array([0, 1])
    if level == 2:
        return 2 * np.eye(2, dtype=np.intp), parent @ np.array([0, 1] if haar else [1, 0])
    neighbours = _HAAR_NEIGHBOURS if haar else _LADDER_NEIGHBOURS
    return parent @ _PARALLELOGRAMS[kind], parent @ neighbours[kind]


def _divide(
    node: _Node, level: int, kind: int, size: Indices, *, haar: bool
) -> tuple[tuple[_Node, _Node], Indices, Indices]:
    """Divide a node's samples into two cosets; give their matrix and the step between them too."""
    matrix, neighbour = ladder_geometry(node.matrix, level, kind, haar=haar)
    anchors = (node.anchor, node.anchor + neighbour)
    spacing = node.spacing
    if level == 1:
        parity = node.positions.sum(axis=1) % 2
        cosets = [node.positions[parity == k] for k in (0, 1)]
    else:
        spacing = spacing * np.array([2, 2] if level == 2 else [2, 1])
        cosets = [_grid((size[0], size[1]), anchor % spacing, spacing) for anchor in anchors]
    first, second = (
        _Node(coset, matrix, anchor, spacing) for coset, anchor in zip(cosets, anchors, strict=True)
    )
    return (first, second), matrix, neighbour


def _turned(node: _Node) -> _Node:
    """Exchange rows and columns."""
    return _Node(
        node.positions[:, ::-1], node.matrix[::-1, ::-1], node.anchor[::-1], node.spacing[::-1]
    )


@dataclass(frozen=True, eq=False)
class _Folding:
    """How positions outside the image are mapped back into it, and on which grid."""

    origin: Indices
    spacing: Indices
    size: Indices
    circular: bool

    def __call__(self, positions: Indices) -> Indices:
        if self.circular:
            return positions % self.size
        index = (positions - self.origin) // self.spacing
        return self.origin + self.spacing * _reflect(index, self.size // self.spacing)


def _folding(node: _Node, size: Indices, *, by_node: bool, extension: Extension) -> _Folding:
    circular = extension == "circular"
    if by_node:
        return _Folding(node.anchor % node.spacing, node.spacing, size, circular)
    return _Folding(np.array([0, 0]), np.array([1, 1]), size, circular)


def _placed_split(
    pair: tuple[_Node, _Node],
    matrix: Indices,
    neighbour: Indices,
    steps: tuple[LadderStep, LadderStep],
    fold: _Folding,
    columns: int,
    *,
    turned: bool,
) -> _Split:
    def pixel(positions: Indices) -> Indices:
        if turned:
            return positions[..., 1] * int(fold.size[0]) + positions[..., 0]
        return positions[..., 0] * columns + positions[..., 1]

    inverse = np.linalg.inv(matrix)
    targets, sources, keeps = [], [], []
    for step in steps:
        positions = pair[step.target].positions
        displaced = positions[0] + (neighbour if step.target == 0 else -neighbour)
        cells = np.rint((positions - positions[0]) @ inverse.T).astype(np.intp)
        low, high = cells.min(axis=0), cells.max(axis=0) + 1
        axes = [np.arange(a - step.before, b + step.after) for a, b in zip(low, high, strict=True)]
        rectangle = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        sources.append(pixel(fold(displaced + rectangle @ matrix.T)))
        keeps.append((cells - low) @ np.array([high[1] - low[1], 1]))
        targets.append(pixel(positions))
    return _Split((targets[0], targets[1]), (sources[0], sources[1]), (keeps[0], keeps[1]))


def _anchored_bands(nodes: list[_Node], shape: tuple[int, int], depth: int) -> list[Indices]:
    """Start every band at its anchor on the torus, as the toolbox's arrays do."""
    if depth == 1:
        i, j = np.indices((shape[0] // 2, shape[1]))
        places = [(2 * i - j % 2 + node.anchor[0], j + node.anchor[1]) for node in nodes]
    else:
        half = len(nodes) // 2
        nodes = nodes[:half] + [_turned(node) for node in nodes[half:]][::-1]
        places = []
        for node, size in zip(nodes, band_shapes(shape, depth), strict=True):
            i, j = np.indices(size)
            places.append(
                (node.anchor[0] + node.spacing[0] * i, node.anchor[1] + node.spacing[1] * j)
            )
    return [(row % shape[0]) * shape[1] + column % shape[1] for row, column in places]


def _raster_bands(nodes: list[_Node], shape: tuple[int, int], depth: int) -> list[Indices]:
    if depth == 1:
        order = [node.positions[np.lexsort(node.positions.T)] for node in nodes]
        flat = [position @ np.array([shape[1], 1]) for position in order]
        return [pixels.reshape(shape[1], shape[0] // 2).T for pixels in flat]
    half = len(nodes) // 2
    nodes = nodes[:half] + [_turned(node) for node in nodes[half:]][::-1]
    flat = [np.sort(node.positions @ np.array([shape[1], 1])) for node in nodes]
    sizes = band_shapes(shape, depth)
    return [pixels.reshape(size) for pixels, size in zip(flat, sizes, strict=True)]
