"""Compute normals and curvature of a triangle surface that may be open, folded and in many parts.

Faces that meet at less than the crease angle approximate one smooth surface, which has a shape operator. Faces that meet
at a larger angle make a fold, which has a curvature on the edge. The sum is the mean curvature measure of the normal
cycle, which is finite on any triangulation (Cohen-Steiner & Morvan 2003, "Restricted Delaunay triangulations and normal
cycle").

Where more than two faces share an edge, each face has a neighbour on either side, the next face around the edge. The
fold of the face is the smaller of both folds. So two closed boxes that touch along an edge have no fold where their
outsides continue each other. No result depends on the order of vertices, faces or corners, except for rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.bounded_loops import turns
from visuohaptic.geometry.elementary import arc_tangent
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.vectors import dot_rows

# Twice the area of a triangle, object radii squared. Below, rounding decides the normal.
SMALLEST_CROSS = 1e-12
# Height of a triangle over its longest edge, object radii. Below, the rounding of the corners to float32 (6e-8) decides
# the normal, and the face is called a sliver.
SMALLEST_HEIGHT = 1e-6
# Faces that meet at a larger angle make a fold. Our choice: a cylinder of ten sides (36°) is smooth, a cylinder of eight
# sides (45°) has edges.
CREASE_ANGLE_DEGREES = 40.0
# How far the curvature of a fold extends to either side, object radii. About two pixels of the eye's working image
# (0.017 radii each at the default distance), so that no fold falls between pixels.
CREASE_WIDTH = 0.03
# Faces at an edge of more than two faces that differ by a smaller angle lie on each other and count as one sheet. Larger
# than the rounding of corners to float32 (6e-8 radii) turns a face that is 1e-4 radii high.
SAME_SHEET_RADIANS = 1e-3


@dataclass(frozen=True)
class FaceAdjacency:
    """Pairs of faces that share an edge of two faces, or that `branch_folds` joins at an edge of more faces.

    Attributes
    ----------
    faces : ndarray of shape (e, 2), int64
        Indices of the two faces.
    edges : ndarray of shape (e, 2), int64
        Index of the shared edge in each of the two faces, 0 to 2. Edge k runs from corner k to corner k + 1.
    aligned : ndarray of shape (e,), bool
        Whether the normals of both faces are on the same side of the surface. At an edge of two faces, both faces then
        run along the edge in opposite directions.
    """

    faces: IntArray
    edges: IntArray
    aligned: BoolArray


@dataclass(frozen=True)
class Branches:
    """Edges that more than two faces share, as n places: one place per face and edge.

    Attributes
    ----------
    faces : ndarray of shape (n,), int64
        Index of the face.
    edges : ndarray of shape (n,), int64
        Index of the shared edge in the face, 0 to 2.
    shared : ndarray of shape (n,), int64
        Index of the shared edge among all edges of the surface, ascending.
    forward : ndarray of shape (n,), bool
        Whether the face runs along the edge from the lower to the higher vertex index of `weld_vertices`.
    """

    faces: IntArray
    edges: IntArray
    shared: IntArray
    forward: BoolArray

    def __getitem__(self, places: BoolArray | NDArray[np.intp]) -> Branches:
        return Branches(
            self.faces[places], self.edges[places], self.shared[places], self.forward[places]
        )


@dataclass(frozen=True)
class SurfaceShape:
    """Normals and curvature of a surface, which can be evaluated at any point of the surface; float64.

    Attributes
    ----------
    corner_normals : ndarray of shape (f, 3, 3)
        Unit normals at the corners of each face, on the side of the winding of the face.
    corner_curvature : ndarray of shape (f, 3)
        Curvedness of the smooth surface at the corners, per object radius.
    crease_angles : ndarray of shape (f, 3)
        Fold angle along each edge, radians; 0 where the surface is smooth.
    crease_scales : ndarray of shape (f, 3)
        Density of the fold's curvature on each edge, per object radius.
    heights : ndarray of shape (f, 3)
        Distance of each edge from the opposite corner, object radii.
    crease_width : float
        How far the curvature of a fold extends to either side, object radii.
    """

    corner_normals: FloatArray
    corner_curvature: FloatArray
    crease_angles: FloatArray
    crease_scales: FloatArray
    heights: FloatArray
    crease_width: float

    @property
    def largest(self) -> float:
        """Upper limit of the curvedness, per object radius: about the curvedness of three right-angled folds."""
        return 3.0 / self.crease_width

    def normals(self, faces: IntArray, weights: FloatArray) -> FloatArray:
        """Compute unit normals (n, 3) at barycentric weights (n, 3) of faces (n,), on the side of each face's winding."""
        corners = self._normal_rows.take(faces, axis=1).reshape(3, 3, -1)
        first, second, third = weights.T
        blend = first * corners[0]
        blend += second * corners[1]
        blend += third * corners[2]
        # A sum of zeros is positive zero.
        blend += 0.0
        return unit_vectors(blend.T)

    def curvature(self, faces: IntArray, weights: FloatArray) -> FloatArray:
        """Compute the curvedness (n,) at barycentric weights (n, 3) of faces (n,), folds included.

        The unit is 1 / object radius, and the range 0 to `largest`. A sphere of radius R has 1/R.
        """
        curvature, heights, scales = np.split(self._curvature_rows.take(faces, axis=1), 3)
        smooth = dot_rows(weights.T, curvature)
        # Corner k + 2 is opposite to edge k. Its weight is the distance from the edge in
        # units of the triangle's height.
        distances = weights.T[[2, 0, 1]] * heights
        reach = np.maximum(1.0 - distances / self.crease_width, 0.0)
        return np.minimum(smooth + dot_rows(reach, scales), self.largest)

    @cached_property
    def _normal_rows(self) -> FloatArray:
        """The components of each face's corner normals, shape (9, f): NumPy gathers single numbers fastest."""
        return np.ascontiguousarray(self.corner_normals.reshape(-1, 9).T)

    @cached_property
    def _curvature_rows(self) -> FloatArray:
        """The corners' curvature, the heights and the folds' densities of each face, shape (9, f)."""
        tables = (self.corner_curvature, self.heights, self.crease_scales)
        return np.ascontiguousarray(np.concatenate([table.T for table in tables]))


_MEASURED: WeakKeyDictionary[Surface, SurfaceShape] = WeakKeyDictionary()


def shape_of(surface: Surface) -> SurfaceShape:
    """Return `measure_shape(surface)`, computed once per surface."""
    if surface not in _MEASURED:
        _MEASURED[surface] = measure_shape(surface)
    return _MEASURED[surface]


def measure_shape(surface: Surface, crease_width: float = CREASE_WIDTH) -> SurfaceShape:
    """Compute the normals and the curvature of a surface in object radii.

    Open sheets, loose parts, mixed windings and edges of more than two faces are allowed. A free edge has no curvature
    across. Vertices at the same position are merged. A sliver, lower than `SMALLEST_HEIGHT`, takes the normal of the
    face across its longest edge, and its folds are moved to that edge. At an edge of more than two faces, a sliver with
    this longest edge has no normal and no curvature.
    """
    faces = weld_vertices(surface)
    adjacency, branches = face_adjacency(faces)
    heights, lengths = _heights_and_lengths(surface)
    slivers = heights.min(axis=1) < SMALLEST_HEIGHT
    crosses = np.where(slivers[:, None], 0.0, surface.face_crosses)
    normals, carriers = carry_normals(
        unit_vectors(crosses), slivers, adjacency, longest_edges(lengths, faces)
    )
    angles = fold_angles(normals, adjacency)
    smooth = angles <= np.radians(CREASE_ANGLE_DEGREES)
    folded = ~smooth
    branch_angles, joined = branch_folds(surface, normals, branches)
    groups, sides = corner_groups(
        faces,
        FaceAdjacency(
            np.concatenate([adjacency.faces[smooth], joined.faces]),
            np.concatenate([adjacency.edges[smooth], joined.edges]),
            np.concatenate([adjacency.aligned[smooth], joined.aligned]),
        ),
    )
    corner_normals = smooth_normals(surface, normals, slivers, sides, groups)
    crease_angles = branch_angles
    crease_angles[adjacency.faces[folded], adjacency.edges[folded]] = angles[folded, None]
    crease_angles = carry_folds(crease_angles, carriers)
    return SurfaceShape(
        corner_normals,
        smooth_curvature(surface, crosses, corner_normals, groups, 1.0 / crease_width),
        crease_angles,
        _crease_scales(crease_angles, heights, crease_width) * (lengths > 0),
        heights,
        crease_width,
    )


def longest_edges(lengths: FloatArray, faces: IntArray) -> IntArray:
    """Return the index (f,) of the longest edge of each face.

    Of equally long edges, the one with the highest opposite vertex counts, so that the order of corners does not matter.
    `lengths` (f, 3) are those of the edges, `faces` (f, 3) the indices of `weld_vertices`.
    """
    longest = lengths == lengths.max(axis=1, keepdims=True)
    return np.where(longest, np.roll(faces, 1, axis=1), -1).argmax(axis=1)


def carry_normals(
    normals: FloatArray, slivers: BoolArray, adjacency: FaceAdjacency, longest: IntArray
) -> tuple[FloatArray, list[IntArray]]:
    """Replace the normal of each sliver by that of the face across its longest edge.

    Parameters
    ----------
    normals : ndarray of shape (f, 3)
        Unit normals of the faces; zero for slivers.
    slivers : ndarray of shape (f,), bool
        Whether each face is a sliver.
    adjacency : FaceAdjacency
        Pairs of faces that share an edge.
    longest : ndarray of shape (f,), int64
        Index of the longest edge of each face, as from `longest_edges`.

    Returns
    -------
    normals : ndarray of shape (f, 3)
        Unit normals on the side of each face's winding. A sliver with only slivers around keeps the zero normal.
    carriers : list of ndarray of shape (m, 3), int64
        Index of the sliver, index of the face that gave the normal, and index of the shared edge in that face.
        The first array has slivers beside other faces, the second has slivers beside slivers of the first array, and
        so on.
    """
    faces = np.concatenate([adjacency.faces, adjacency.faces[:, ::-1]])
    edges = np.concatenate([adjacency.edges, adjacency.edges[:, ::-1]])
    sides = np.where(np.tile(adjacency.aligned, 2), 1.0, -1.0)
    sliver, face = faces.T
    across = slivers[sliver] & (edges[:, 0] == longest[sliver])
    sliver, face, edge, sides = sliver[across], face[across], edges[across, 1], sides[across]
    normals = normals.copy()
    carriers: list[IntArray] = []
    # Each turn but the last gives a normal to a sliver at least.
    for _ in turns(len(normals) + 1, "the search for normals of slivers"):
        has_normal: BoolArray = np.any(normals != 0, axis=1)
        ready = np.flatnonzero(~has_normal[sliver] & has_normal[face])
        if not len(ready):
            break
        ready = ready[np.unique(sliver[ready], return_index=True)[1]]
        normals[sliver[ready]] = sides[ready, None] * normals[face[ready]]
        carriers.append(np.stack([sliver[ready], face[ready], edge[ready]], axis=1))
    return normals, carriers


def carry_folds(crease_angles: FloatArray, carriers: list[IntArray]) -> FloatArray:
    """Return crease angles (f, 3), radians, with the folds of slivers moved to the faces that gave their normals.

    `carriers` is the second result of `carry_normals`. In a row of slivers the folds move from sliver to sliver. The
    larger fold is kept where two folds meet on an edge.
    """
    crease_angles = crease_angles.copy()
    for sliver, face, edge in (carrier.T for carrier in reversed(carriers)):
        np.maximum.at(crease_angles, (face, edge), crease_angles[sliver].max(axis=1))
        crease_angles[sliver] = 0.0
    return crease_angles


def weld_vertices(surface: Surface) -> IntArray:
    """Return vertex indices (f, 3) of the corners, in which vertices at the same position have one index.

    Positions are compared in float32, the precision of stored meshes.
    """
    # Adding zero turns -0 into +0: the comparison is by bytes.
    positions = np.ascontiguousarray(surface.vertices, dtype=np.float32) + np.float32(0.0)
    keys = positions.view(np.dtype((np.void, 12))).reshape(-1)
    _, index = np.unique(keys, return_inverse=True)
    return index.reshape(-1)[surface.faces].astype(np.int64)


def face_adjacency(faces: IntArray) -> tuple[FaceAdjacency, Branches]:
    """Find the faces that share an edge, from vertex indices (f, 3) of `weld_vertices`.

    Returns the pairs of faces at edges of two faces, and the faces at edges of more faces. An edge without length is
    shared by no faces.
    """
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((high, low))
    low, high, forward = low[order], high[order], (start < end)[order]
    same = (low[1:] == low[:-1]) & (high[1:] == high[:-1]) & (low[1:] != high[1:])
    first = np.flatnonzero(np.append(True, ~same))
    counts = np.diff(np.append(first, len(order)))
    pair = first[counts == 2]
    pairs = np.stack([order[pair], order[pair + 1]], axis=1)
    shared = np.repeat(np.arange(len(counts)), counts)
    branching = counts[shared] > 2
    places = order[branching]
    return (
        FaceAdjacency(pairs // 3, pairs % 3, forward[pair + 1] != forward[pair]),
        Branches(places // 3, places % 3, shared[branching], forward[branching]),
    )


def branch_folds(
    surface: Surface, normals: FloatArray, branches: Branches
) -> tuple[FloatArray, FaceAdjacency]:
    """Compute folds at edges of more than two faces, and which faces continue each other there.

    Faces around an edge that differ by less than `SAME_SHEET_RADIANS` from the next face are one sheet. Between
    neighbouring sheets is a fold: 0 if the sheets continue each other, pi if they lie on each other. The fold of a face
    is the smaller of the folds on both sides of its sheet.

    Parameters
    ----------
    surface : Surface
        The surface, f faces.
    normals : ndarray of shape (f, 3)
        Unit normals of the faces. Faces with normal zero take no part.
    branches : Branches
        The edges and their faces.

    Returns
    -------
    angles : ndarray of shape (f, 3)
        Fold angle along each edge, radians; 0 where the surface is smooth, and at edges that are not in `branches`.
    joined : FaceAdjacency
        Pairs that connect the faces of each sheet, and sheets with a smooth fold between them.
    """
    angles = np.zeros((len(surface.faces), 3))
    branches, gaps = _sort_around(surface, normals, branches)
    last = branches.shared != np.append(branches.shared[1:], -1)
    first = np.roll(last, 1)
    following = np.arange(1, len(gaps) + 1)
    following[last] = np.flatnonzero(first)
    # The widest gap, which is the last one, separates even faces that are all on one side.
    separate = last | (gaps > SAME_SHEET_RADIANS)
    folds = np.abs(np.pi - gaps)
    ends = np.flatnonzero(separate)
    sheets = np.cumsum(np.roll(separate, 1)) - 1
    before = np.empty(len(ends))
    before[sheets[following[ends]]] = folds[ends]
    fold = np.minimum(before, folds[ends])[sheets]
    crease = np.radians(CREASE_ANGLE_DEGREES)
    angles[branches.faces, branches.edges] = np.where(fold > crease, fold, 0.0)
    rows = np.flatnonzero(~separate | (folds <= crease))
    pairs = np.stack([rows, following[rows]], axis=1)
    # Faces of one sheet have the same side if they run along the edge in one direction, faces across in opposite ones.
    opposite = branches.forward[pairs[:, 0]] != branches.forward[pairs[:, 1]]
    return angles, FaceAdjacency(
        branches.faces[pairs], branches.edges[pairs], opposite == separate[rows]
    )


def _sort_around(
    surface: Surface, normals: FloatArray, branches: Branches
) -> tuple[Branches, FloatArray]:
    """Sort the faces of each edge around it, from behind the widest gap, and compute the angle (n,) to the next face."""
    directions, known = _directions_around(surface, normals, branches)
    counts = np.bincount(branches.shared[known], minlength=branches.shared.max(initial=-1) + 1)
    # A single face with a normal has no neighbour.
    known &= counts[branches.shared] > 1
    branches, directions = branches[known], directions[known]
    order = np.lexsort((directions, branches.shared))
    branches, directions = branches[order], directions[order]
    last = np.flatnonzero(branches.shared != np.append(branches.shared[1:], -1))
    counts = np.diff(last, prepend=-1)
    gaps = np.diff(directions, append=0.0)
    gaps[last] = directions[last - counts + 1] + 2 * np.pi - directions[last]
    widest = np.lexsort((gaps, branches.shared))[last]
    order = np.lexsort((np.arange(len(gaps)) <= np.repeat(widest, counts), branches.shared))
    return branches[order], gaps[order]


def _directions_around(
    surface: Surface, normals: FloatArray, branches: Branches
) -> tuple[FloatArray, BoolArray]:
    """Compute the angle (n,) of each face around its edge, radians, -pi to pi, and whether it is known."""
    # Rounded as for `weld_vertices`, so that all faces of an edge have the same axes.
    corners = surface.vertices.astype(np.float32).astype(np.float64)[surface.faces[branches.faces]]
    rows = np.arange(len(corners))
    start, end = corners[rows, branches.edges], corners[rows, (branches.edges + 1) % 3]
    run = unit_vectors(end - start)
    along = np.where(branches.forward[:, None], run, -run)
    inwards = np.cross(normals[branches.faces], run)
    first = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)])
    second = np.cross(along, first)
    across, ahead = (np.einsum("nd,nd->n", inwards, axis) for axis in (second, first))
    angles = arc_tangent(np.abs(across), ahead)
    return np.where(across < 0, -angles, angles), np.any(inwards != 0, axis=1)


def fold_angles(normals: FloatArray, adjacency: FaceAdjacency) -> FloatArray:
    """Compute the fold angle (e,) across each shared edge from unit normals (f, 3).

    The unit is radians: 0 is flat, pi is folded back. Beside a face with normal zero the angle is 0.
    """
    first, second = normals[adjacency.faces[:, 0]], normals[adjacency.faces[:, 1]]
    second = np.where(adjacency.aligned[:, None], second, -second)
    sine = _lengths(np.cross(first, second))
    return arc_tangent(sine, np.einsum("nd,nd->n", first, second))


def corner_groups(faces: IntArray, joined: FaceAdjacency) -> tuple[IntArray, FloatArray]:
    """Group the corners around each vertex that no fold separates.

    Parameters
    ----------
    faces : ndarray of shape (f, 3), int64
        Indices of `weld_vertices`.
    joined : FaceAdjacency
        Pairs of faces that meet without a fold.

    Returns
    -------
    groups : ndarray of shape (f, 3), int64
        Group of each corner.
    sides : ndarray of shape (f, 3)
        -1 for corners where the face is to be flipped and 1 where it is kept, so that all faces of a group have the
        same winding; 0 in a group that has no two sides.
    """
    # Each corner is two nodes, one per side of the face. In a group with two sides they are not connected.
    count = faces.size
    edges, following = joined.edges, (joined.edges + 1) % 3
    upwards = faces[joined.faces, edges] < faces[joined.faces, following]
    corners = [
        3 * joined.faces + np.where(upwards == low, edges, following) for low in (True, False)
    ]
    first, second = np.concatenate(corners).T
    across = np.tile(np.where(joined.aligned, 0, count), 2)
    rows = np.concatenate([first, first + count])
    columns = np.concatenate([second + across, second + count - across])
    front, back = _components(rows, columns, 2 * count).reshape(2, -1, 3).astype(np.int64)
    return np.minimum(front, back), np.sign(back - front).astype(np.float64)


def _components(starts: IntArray, ends: IntArray, count: int) -> IntArray:
    """Return the connected component of each of `count` nodes in a graph with edges from starts to ends."""
    # Imported here: the parameters import this module, and SciPy's graphs take 0.3 s.
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(starts), np.int8), (starts, ends)), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def smooth_normals(
    surface: Surface,
    face_normals: FloatArray,
    slivers: BoolArray,
    sides: FloatArray,
    groups: IntArray,
) -> FloatArray:
    """Compute unit normals (f, 3, 3) at the corners: the mean of face normals over each corner group.

    Parameters
    ----------
    surface : Surface
        The surface, f faces.
    face_normals : ndarray of shape (f, 3)
        Unit normals of the faces.
    slivers : ndarray of shape (f,), bool
        Faces without weight in the mean.
    sides : ndarray of shape (f, 3)
        -1 for faces to flip at a corner, as from `corner_groups`; 0 where no mean is wanted.
    groups : ndarray of shape (f, 3), int64
        Groups of corners, as from `corner_groups`.

    Returns
    -------
    ndarray of shape (f, 3, 3)
        Normals on the side of each face's winding. Weights are the angles at the corner, so that the triangulation of
        a flat corner has no influence (Thürmer & Wüthrich 1998). Where the mean is zero, the normal of the face.
    """
    angles = np.where(slivers[:, None], 0.0, _corner_angles(surface))
    turned = (sides[:, :, None] * face_normals[:, None, :]) * angles[:, :, None]
    sums = np.zeros((groups.max(initial=-1) + 1, 3))
    for axis in range(3):
        sums[:, axis] = np.bincount(
            groups.reshape(-1), turned[..., axis].reshape(-1), minlength=len(sums)
        )
    normals = sides[:, :, None] * unit_vectors(sums)[groups]
    lost = ~np.any(normals, axis=2)
    return np.where(lost[:, :, None], face_normals[:, None, :], normals)


def smooth_curvature(
    surface: Surface,
    crosses: FloatArray,
    corner_normals: FloatArray,
    groups: IntArray,
    largest: float,
) -> FloatArray:
    """Compute the curvedness (f, 3) of the smooth surface at each corner, per object radius.

    The shape operator of a face is the derivative of its interpolated normal (Rusinkiewicz 2004, "Estimating curvatures
    and their derivatives on triangle meshes"). Curvedness is the root mean square of the two principal curvatures
    (Koenderink & van Doorn 1992). The result is the mean over each corner group, weighted by area.

    Parameters
    ----------
    surface : Surface
        The surface, f faces, in object radii.
    crosses : ndarray of shape (f, 3)
        Cross products of two edges of each face. Faces with zero have no weight.
    corner_normals : ndarray of shape (f, 3, 3)
        Unit normals, as from `smooth_normals`.
    groups : ndarray of shape (f, 3), int64
        Groups of corners, as from `corner_groups`.
    largest : float
        Upper limit of the curvedness of a face.
    """
    double_area = _lengths(crosses)
    solid = double_area > SMALLEST_CROSS
    edges = surface.triangles[:, 1:] - surface.triangles[:, :1]
    tangent = unit_vectors(edges[:, 0])
    basis = np.stack([tangent, np.cross(unit_vectors(crosses), tangent)], axis=1)
    steps = np.einsum("fad,fbd->fab", basis, edges)
    turns = np.einsum("fad,fbd->fab", basis, corner_normals[:, 1:] - corner_normals[:, :1])
    steps[~solid] = np.eye(2)
    operator = np.where(solid[:, None, None], _divide(turns, steps), 0.0)
    symmetric = 0.5 * (operator + operator.transpose(0, 2, 1))
    curvedness = np.minimum(np.sqrt(0.5 * np.sum(symmetric**2, axis=(1, 2))), largest)
    weights = np.repeat(np.where(solid, double_area, 0.0), 3)
    flat_groups = groups.reshape(-1)
    mass = np.bincount(flat_groups, weights)
    total = np.bincount(flat_groups, weights * np.repeat(curvedness, 3))
    return np.divide(total, mass, out=np.zeros_like(total), where=mass > 0)[groups]


def _divide(turns: FloatArray, steps: FloatArray) -> FloatArray:
    """Compute the 2 x 2 matrices that map `steps` to `turns`, without LAPACK: its bits depend on the processor."""
    first, second, third, fourth = np.moveaxis(steps.reshape(-1, 4), 1, 0)
    inverse = np.stack([fourth, -second, -third, first], axis=1).reshape(-1, 2, 2)
    determinant = first * fourth - second * third
    return np.einsum("fab,fbc->fac", turns, inverse) / determinant[:, None, None]


def unit_vectors(vectors: FloatArray) -> FloatArray:
    """Scale vectors along the last axis to length 1; vectors not longer than `SMALLEST_CROSS` become zero."""
    lengths = _lengths(vectors)[..., None]
    # Short vectors are divided by infinity, which gives zero.
    return vectors / np.where(lengths > SMALLEST_CROSS, lengths, np.inf)


def _lengths(vectors: FloatArray) -> FloatArray:
    """Compute lengths along the last axis, summed by Python: faster than NumPy for two or three components."""
    squares: FloatArray = sum(component * component for component in np.moveaxis(vectors, -1, 0))
    return np.sqrt(squares)


def _heights_and_lengths(surface: Surface) -> tuple[FloatArray, FloatArray]:
    corners = surface.triangles
    lengths = _lengths(np.roll(corners, -1, axis=1) - corners)
    double_area = _lengths(surface.face_crosses)[:, None]
    return np.divide(double_area, lengths, out=np.zeros_like(lengths), where=lengths > 0), lengths


def _corner_angles(surface: Surface) -> FloatArray:
    corners = surface.triangles
    onward = np.roll(corners, -1, axis=1) - corners
    backward = np.roll(corners, 1, axis=1) - corners
    sine = _lengths(np.cross(onward, backward))
    return arc_tangent(sine, np.einsum("fkd,fkd->fk", onward, backward))


def _crease_scales(angles: FloatArray, heights: FloatArray, width: float) -> FloatArray:
    # A fold has the mean curvature angle / 2 per unit of length; half of it belongs to each
    # face. The integral of the tent max(1 - d / width, 0) over a triangle that narrows from
    # its edge is `share` per unit of length. Dividing by `share` puts the whole half on the
    # face, also on a small face.
    reach = np.minimum(heights, width)
    share = reach - 0.5 * reach**2 * (1.0 / np.maximum(heights, 1e-12) + 1.0 / width)
    share += reach * reach * reach / (3.0 * np.maximum(heights, 1e-12) * width)
    return np.divide(0.25 * angles, share, out=np.zeros_like(angles), where=share > 1e-9)
