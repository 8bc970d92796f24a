"""Normals and curvature of a triangle surface that may be open, folded and in many parts.

Faces that meet at less than the crease angle approximate one smooth surface, with a shape operator;
faces that meet at more are folded there, with a curvature on the edge. Together these are the mean
curvature measure of the normal cycle (Cohen-Steiner & Morvan 2003, "Restricted Delaunay
triangulations and normal cycle"), which is finite on any triangulation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.elementary import arc_tangent
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.vectors import dot_rows

# Twice the area of a triangle in object radii squared, below which its normal is rounding.
SMALLEST_CROSS = 1e-12
# Height of a triangle over its longest edge, object radii, below which the rounding of its corners to float32 (6e-8)
# decides its normal: such a face is a sliver.
SMALLEST_HEIGHT = 1e-6
# Faces that meet at a larger angle have a fold, not a rounding. Our choice: a cylinder of ten sides (36°) is round,
# one of eight (45°) has edges.
CREASE_ANGLE_DEGREES = 40.0
# Reach of a fold's curvature to either side, object radii: some two pixels of the eye's working image (0.017 radii
# each at the default distance), so that no fold falls between pixels.
CREASE_WIDTH = 0.03


@dataclass(frozen=True)
class FaceAdjacency:
    """Pairs of faces that share an edge.

    `faces` (e, 2), int64, are the two faces, and `edges` (e, 2), int64, the number of the shared
    edge within each, 0 to 2; edge k runs from corner k to corner k + 1. `aligned` (e,) says whether
    the two are wound alike, as they run along the edge in opposite directions.
    """

    faces: IntArray
    edges: IntArray
    aligned: BoolArray


@dataclass(frozen=True)
class SurfaceShape:
    """Normals and curvature of a surface, ready to be looked up at any point of it; float64.

    `corner_normals` (f, 3, 3) are unit, on the side of the face's winding, and `corner_curvature` (f, 3)
    the curvedness of the smooth surface, per object radius. `crease_angles` (f, 3) are the folds along
    each edge, radians, and `crease_scales` (f, 3) the density of their curvature on the edge. `heights`
    (f, 3) are the distances of each edge from the corner across, and `crease_width` is how far a
    fold's curvature reaches to either side, object radii.
    """

    corner_normals: FloatArray
    corner_curvature: FloatArray
    crease_angles: FloatArray
    crease_scales: FloatArray
    heights: FloatArray
    crease_width: float

    @property
    def largest(self) -> float:
        """The curvedness at which the measure stops, per object radius: that of three folds by a right angle."""
        return 3.0 / self.crease_width

    def normals(self, faces: IntArray, weights: FloatArray) -> FloatArray:
        """Interpolate unit normals (n, 3), on the side of each face's winding, by barycentric weights (n, 3)."""
        corners = self._normal_rows.take(faces, axis=1).reshape(3, 3, -1)
        first, second, third = weights.T
        blend = first * corners[0]
        blend += second * corners[1]
        blend += third * corners[2]
        # A sum of zeros is positive zero.
        blend += 0.0
        return unit_vectors(blend.T)

    def curvature(self, faces: IntArray, weights: FloatArray) -> FloatArray:
        """Give the curvedness (n,), folds included, at barycentric weights (n, 3) of faces (n,).

        It is at least 0, per object radius: 1/R on a sphere of radius R.
        """
        curvature, heights, scales = np.split(self._curvature_rows.take(faces, axis=1), 3)
        smooth = dot_rows(weights.T, curvature)
        # The corner across edge k is k + 2, and its weight is the distance from the edge
        # in units of the triangle's height.
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
    """Give what `measure_shape` gives, measured once for a surface, however often it is looked at."""
    if surface not in _MEASURED:
        _MEASURED[surface] = measure_shape(surface)
    return _MEASURED[surface]


def measure_shape(surface: Surface, crease_width: float = CREASE_WIDTH) -> SurfaceShape:
    """Measure the normals and the curvature of a surface.

    Open sheets, loose parts, mixed windings and edges of more than two faces are allowed; a free
    edge has no curvature across it. Vertices at the same place are taken as one. A sliver, lower than
    `SMALLEST_HEIGHT`, has the normal of the face across its longest edge, and its folds lie on that edge.
    """
    faces = weld_vertices(surface)
    adjacency = face_adjacency(faces)
    heights, lengths = _heights_and_lengths(surface)
    slivers = heights.min(axis=1) < SMALLEST_HEIGHT
    crosses = np.where(slivers[:, None], 0.0, surface.face_crosses)
    normals, carriers = carry_normals(unit_vectors(crosses), slivers, adjacency, lengths)
    signs = consistent_sides(len(faces), adjacency)
    angles = fold_angles(normals, adjacency)
    smooth = angles <= np.radians(CREASE_ANGLE_DEGREES)
    groups = corner_groups(faces, adjacency, smooth)
    corner_normals = smooth_normals(surface, normals, slivers, signs, groups)
    crease_angles = np.zeros((len(faces), 3))
    np.maximum.at(
        crease_angles, (adjacency.faces[~smooth], adjacency.edges[~smooth]), angles[~smooth, None]
    )
    crease_angles = carry_folds(crease_angles, carriers)
    return SurfaceShape(
        corner_normals,
        smooth_curvature(surface, crosses, corner_normals, groups, 1.0 / crease_width),
        crease_angles,
        _crease_scales(crease_angles, heights, crease_width) * (lengths > 0),
        heights,
        crease_width,
    )


def carry_normals(
    normals: FloatArray, slivers: BoolArray, adjacency: FaceAdjacency, lengths: FloatArray
) -> tuple[FloatArray, list[IntArray]]:
    """Replace the normal of each sliver by that of the face across its longest edge.

    Parameters
    ----------
    normals : ndarray of shape (f, 3)
        Unit normals of the faces; those of slivers are zero.
    slivers : ndarray of shape (f,), bool
        The faces whose normals are rounding.
    adjacency : FaceAdjacency
        The pairs of faces that share an edge.
    lengths : ndarray of shape (f, 3)
        The lengths of the edges.

    Returns
    -------
    normals : ndarray of shape (f, 3)
        The normals by each face's winding. A sliver beside slivers only keeps the zero normal.
    carriers : list of ndarray of shape (m, 3), int64
        Sliver, the face that gave its normal, and the number of the shared edge in that face. The
        first array has the slivers beside other faces, the second those beside slivers of the first,
        and so on.
    """
    faces = np.concatenate([adjacency.faces, adjacency.faces[:, ::-1]])
    edges = np.concatenate([adjacency.edges, adjacency.edges[:, ::-1]])
    sides = np.where(np.tile(adjacency.aligned, 2), 1.0, -1.0)
    sliver, face = faces.T
    across = slivers[sliver] & (edges[:, 0] == lengths.argmax(axis=1)[sliver])
    sliver, face, edge, sides = sliver[across], face[across], edges[across, 1], sides[across]
    normals = normals.copy()
    carriers: list[IntArray] = []
    while True:
        known: BoolArray = np.any(normals != 0, axis=1)
        ready = np.flatnonzero(~known[sliver] & known[face])
        if not len(ready):
            return normals, carriers
        ready = ready[np.unique(sliver[ready], return_index=True)[1]]
        normals[sliver[ready]] = sides[ready, None] * normals[face[ready]]
        carriers.append(np.stack([sliver[ready], face[ready], edge[ready]], axis=1))


def carry_folds(crease_angles: FloatArray, carriers: list[IntArray]) -> FloatArray:
    """Move the folds of each sliver, crease angles (f, 3) in radians, to the edge of the face that gave its normal.

    `carriers` are as `carry_normals` returns them. Folds of a sliver beside slivers move on from one to the next.
    """
    crease_angles = crease_angles.copy()
    for sliver, face, edge in (carrier.T for carrier in reversed(carriers)):
        np.maximum.at(crease_angles, (face, edge), crease_angles[sliver].max(axis=1))
        crease_angles[sliver] = 0.0
    return crease_angles


def weld_vertices(surface: Surface) -> IntArray:
    """Give each face's corners (f, 3) numbers by place, so that equal vertices are one.

    Places are compared in float32, as meshes are stored.
    """
    # Adding zero makes one of the two signs of zero.
    places = np.ascontiguousarray(surface.vertices, dtype=np.float32) + np.float32(0.0)
    keys = places.view(np.dtype((np.void, 12))).reshape(-1)
    _, index = np.unique(keys, return_inverse=True)
    return index.reshape(-1)[surface.faces].astype(np.int64)


def face_adjacency(faces: IntArray) -> FaceAdjacency:
    """Find the pairs of faces that share an edge, from welded vertex numbers (f, 3).

    An edge of m faces gives m - 1 pairs; edges without length give none.
    """
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((high, low))
    low, high, forward = low[order], high[order], (start < end)[order]
    pair = (low[1:] == low[:-1]) & (high[1:] == high[:-1]) & (low[1:] != high[1:])
    first, second = order[:-1][pair], order[1:][pair]
    return FaceAdjacency(
        np.stack([first // 3, second // 3], axis=1),
        np.stack([first % 3, second % 3], axis=1),
        (forward[1:] != forward[:-1])[pair],
    )


def consistent_sides(count: int, adjacency: FaceAdjacency) -> FloatArray:
    """Find which of `count` faces to flip (-1) so that neighbours have the same winding; 1 is to keep.

    The first face of each part is kept, and so is every face of a one-sided part.
    """
    # Each face is two nodes, one for each side; in an orientable part the two sides fall apart.
    first, second = adjacency.faces.T
    across = np.where(adjacency.aligned, 0, count)
    rows = np.concatenate([first, first + count])
    columns = np.concatenate([second + across, second + count - across])
    labels = _components(rows, columns, 2 * count)
    front, back = labels[:count], labels[count:]
    first_face = np.full(labels.max(initial=-1) + 1, 2 * count)
    np.minimum.at(first_face, labels, np.arange(2 * count))
    return np.where(first_face[front] <= first_face[back], 1.0, -1.0)


def fold_angles(normals: FloatArray, adjacency: FaceAdjacency) -> FloatArray:
    """Give the angle (e,) by which the surface turns along each shared edge, from unit normals (f, 3).

    Radians, 0 (flat) to pi (folded back); 0 beside a face without area, whose normal is zero.
    """
    first, second = normals[adjacency.faces[:, 0]], normals[adjacency.faces[:, 1]]
    second = np.where(adjacency.aligned[:, None], second, -second)
    sine = _lengths(np.cross(first, second))
    return arc_tangent(sine, np.einsum("nd,nd->n", first, second))


def corner_groups(faces: IntArray, adjacency: FaceAdjacency, smooth: BoolArray) -> IntArray:
    """Join the corners around each vertex that no fold parts: the number (f, 3), int64, of each corner's group.

    `faces` (f, 3) are welded vertex numbers, and `smooth` (e,) says whether the surface runs on
    smoothly across each pair.
    """
    face_pairs, edge_pairs = adjacency.faces[smooth], adjacency.edges[smooth]
    starts = 3 * face_pairs + edge_pairs
    ends = 3 * face_pairs + (edge_pairs + 1) % 3
    # Faces wound alike run along the edge in opposite directions: start meets end.
    opposite = adjacency.aligned[smooth]
    rows = np.concatenate([starts[:, 0], ends[:, 0]])
    columns = np.concatenate(
        [
            np.where(opposite, ends[:, 1], starts[:, 1]),
            np.where(opposite, starts[:, 1], ends[:, 1]),
        ]
    )
    return _components(rows, columns, faces.size).reshape(-1, 3).astype(np.int64)


def _components(starts: IntArray, ends: IntArray, count: int) -> IntArray:
    """Give the number of each node's part, (count,), in a graph of links from starts to ends."""
    # Parameters import this module, and SciPy's graphs take 0.3 s.
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(starts), np.int8), (starts, ends)), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def smooth_normals(
    surface: Surface,
    face_normals: FloatArray,
    slivers: BoolArray,
    signs: FloatArray,
    groups: IntArray,
) -> FloatArray:
    """Average face normals (f, 3) over each corner group, weighted by angle: (f, 3, 3), by each face's winding.

    No triangulation of a flat corner changes the weighting (Thürmer & Wüthrich 1998). Slivers (f,) have no
    weight. `signs` (f,) are -1 for faces wound against their part. The face's own normal stands in
    where the average vanishes.
    """
    angles = np.where(slivers[:, None], 0.0, _corner_angles(surface))
    turned = (signs[:, None] * face_normals)[:, None, :] * angles[:, :, None]
    sums = np.zeros((groups.max(initial=-1) + 1, 3))
    for axis in range(3):
        sums[:, axis] = np.bincount(
            groups.reshape(-1), turned[..., axis].reshape(-1), minlength=len(sums)
        )
    normals = signs[:, None, None] * unit_vectors(sums)[groups]
    lost = ~np.any(normals, axis=2)
    return np.where(lost[:, :, None], face_normals[:, None, :], normals)


def smooth_curvature(
    surface: Surface,
    crosses: FloatArray,
    corner_normals: FloatArray,
    groups: IntArray,
    largest: float,
) -> FloatArray:
    """Give the curvedness (f, 3) of the smooth surface at each corner, 0 to `largest`, per object radius.

    Each face's shape operator is the derivative of its interpolated normal (Rusinkiewicz 2004,
    "Estimating curvatures and their derivatives on triangle meshes"); its curvedness is the root
    mean square of the principal curvatures (Koenderink & van Doorn 1992), averaged over each corner
    group by area. Faces whose cross products `crosses` (f, 3) are zero have no weight. The curvedness
    stops at `largest`.
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
    """Give the 2 x 2 matrices that take `steps` to `turns`; LAPACK's depend on the processor."""
    first, second, third, fourth = np.moveaxis(steps.reshape(-1, 4), 1, 0)
    inverse = np.stack([fourth, -second, -third, first], axis=1).reshape(-1, 2, 2)
    determinant = first * fourth - second * third
    return np.einsum("fab,fbc->fac", turns, inverse) / determinant[:, None, None]


def unit_vectors(vectors: FloatArray) -> FloatArray:
    """Scale vectors along the last axis to length 1; one shorter than rounding becomes zero."""
    lengths = _lengths(vectors)[..., None]
    # What is divided by infinity is zero.
    return vectors / np.where(lengths > SMALLEST_CROSS, lengths, np.inf)


def _lengths(vectors: FloatArray) -> FloatArray:
    """Give the lengths along the last axis; summed one by one, which is faster for so few."""
    squares: FloatArray = sum(part * part for part in np.moveaxis(vectors, -1, 0))
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
    # Half of the fold's mean curvature, angle / 2 for each unit of its length, belongs to
    # either face. The tent max(1 - d / width, 0) over a triangle that narrows from its edge
    # integrates to `share` for each unit of length, so the whole half lies on the face
    # however small it is.
    reach = np.minimum(heights, width)
    share = reach - 0.5 * reach**2 * (1.0 / np.maximum(heights, 1e-12) + 1.0 / width)
    share += reach * reach * reach / (3.0 * np.maximum(heights, 1e-12) * width)
    return np.divide(0.25 * angles, share, out=np.zeros_like(angles), where=share > 1e-9)
