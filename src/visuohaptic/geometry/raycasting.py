"""Cast rays at a triangle surface with Embree, and compute hits in float64.

Embree finds the first face of a ray in float32; the distance is computed in float64 from the plane of that face. Within
about 1e-7 of an edge, Embree may return a wrong face, or different faces on different processors. It also misses faces
that are narrower than that. Such doubtful rays are recomputed in float64, with these rules:

- A ray through an edge or a vertex hits the face there with the nearest plane along the ray; of equally near planes,
  the face with the lowest index.
- A ray through faces that lie on each other hits the nearest face; of equally near faces, the lowest index.
- A ray in the plane of a face does not hit this face, but may hit its neighbours.
- No ray hits a face without area.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.cast_rays import Scene
from visuohaptic.geometry.nearest import nearest_on
from visuohaptic.geometry.overlaps import blocks_by_count, overlapping_faces, repeat_with_ranges
from visuohaptic.geometry.scenes import SCENES, installed_package
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.vectors import cross, dot

MISS = -1

Pairs = Iterator[tuple[IntArray, IntArray]]
"""Blocks of pairs: indices of rays, ascending, and of faces that they may hit."""

Suspects = Callable[[FloatArray], BoolArray]

# Largest error of Embree's float32 across a ray, in units of the surface: eight roundings of coordinates
# of size 3. Within this distance of an edge, Embree may find the wrong face.
LATERAL_ERROR = 2e-6
# Rays that look for candidate faces around a doubtful ray are offset by this distance.
_BUNDLE_RADIUS = 3e-6
_BUNDLE = np.array(
    [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1], [0.7, 0.7], [-0.7, 0.7], [-0.7, -0.7], [0.7, -0.7]]
)
# Rounding of a triple product of float64 vectors, relative to their lengths.
_ROUNDING = 2e-15
# A face lower than this may lie between the rays of a bundle, and float32 may miss it.
_NARROW = 2 * (LATERAL_ERROR + _BUNDLE_RADIUS)
# Of two faces closer than this (units of the surface), float32 may find the farther face.
_DEPTH_ERROR = 4e-6
# A face lower than this, relative to its longest edge, is a line in float64.
_LINE = 1e-12
# Rays within this distance of a narrow face are compared with it.
_BOX_MARGIN = 1e-4
# Largest number of pairs of a ray and a face that are compared at once; limits the memory.
_MOST_PAIRS = 1 << 16
# Corners and faces of a cube with edges of length 1, centred at the origin.
_BOX_CORNERS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
_BOX_FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)


@dataclass(frozen=True)
class Hits:
    """First hits of n rays.

    Attributes
    ----------
    distance : ndarray of shape (n,), float64
        Distance along the ray in lengths of its direction; infinite for a miss.
    face : ndarray of shape (n,), int64
        Index of the face that was hit, or `MISS`.
    """

    distance: FloatArray
    face: IntArray

    @property
    def hit(self) -> BoolArray:
        """Whether each ray hits the surface, shape (n,)."""
        return self.face != MISS


class RayCaster:
    """A surface prepared for ray casting.

    Parameters
    ----------
    surface : Surface
        The surface; near the origin and of about unit size, because faces are found in float32.
    package : str, optional
        Name of a package in `scenes.SCENES`; by default the first installed package.

    Attributes
    ----------
    surface : Surface
        The surface.
    bounds : ndarray of shape (2, 3)
        Lower and upper corner of the bounding box.
    """

    def __init__(self, surface: Surface, package: str | None = None) -> None:
        self.surface = surface
        self.bounds = np.stack([surface.vertices.min(axis=0), surface.vertices.max(axis=0)])
        self._corners = surface.triangles
        self._planes = _face_planes(surface)
        heights = LATERAL_ERROR * np.linalg.norm(surface.face_crosses, axis=1)
        # Transposed for casts: NumPy gathers single numbers fastest.
        self._plane_rows = np.ascontiguousarray(self._planes.T)
        longest = self._planes[:, 4]
        self._narrow = np.flatnonzero((heights < _NARROW * longest) & (heights > _LINE * longest))
        make_scene = SCENES[package or installed_package()]
        self._scene: Scene = make_scene(surface.vertices, surface.faces)
        if len(self._narrow):
            boxes = _boxes_around(self._corners[self._narrow])
            self._around_narrow: Scene = make_scene(*boxes)

    @property
    def reach(self) -> float:
        """Diagonal of the bounding box: an upper bound of the distance between points of the surface."""
        diagonal = self.bounds[1] - self.bounds[0]
        return float(np.sqrt(dot(diagonal, diagonal)))

    def first_hits(
        self, origins: FloatArray, directions: FloatArray, suspects: Suspects | None = None
    ) -> Hits:
        """Compute the first hit of each ray, with the same bits on every x86-64 processor.

        Rays that hit near an edge or vertex, or at a grazing angle, are recomputed in float64, because float32 may
        have found the wrong face.

        Parameters
        ----------
        origins, directions : ndarray of shape (n, 3)
            Origin and direction of each ray.
        suspects : callable, optional
            Takes the distances (n,) of the first cast and returns further rays to recompute, (n,), bool, such as a
            miss between hits. The hit of a ray depends on the other rays only if `suspects` does.

        Returns
        -------
        Hits
            First hit of each ray.
        """
        hits, doubtful = self._cast(origins, directions)
        if suspects is not None:
            doubtful |= suspects(hits.distance)
        narrow_rays, narrow_hits = self._nearest_pairs(
            self._narrow_pairs(origins, directions), origins, directions
        )
        # A ray that surely hits a narrow face loses its doubtful hit, so that `_recompute` can't keep it.
        doubtful_narrow = narrow_rays[doubtful[narrow_rays]]
        hits.distance[doubtful_narrow], hits.face[doubtful_narrow] = np.inf, MISS
        doubtful_rays = np.flatnonzero(doubtful)
        if len(doubtful_rays):
            first_cast = _take(hits, doubtful_rays)
            _put(
                hits,
                doubtful_rays,
                self._recompute(origins[doubtful_rays], directions[doubtful_rays], first_cast),
            )
        nearer = narrow_hits.distance < hits.distance[narrow_rays]
        _put(hits, narrow_rays[nearer], _take(narrow_hits, nearer))
        twins = self._nearest_pairs(self._twin_pairs(hits.face), origins, directions)
        _put_nearer(hits, *twins)
        return hits

    def weights(self, points: FloatArray, faces: IntArray) -> FloatArray:
        """Compute the barycentric weights (n, 3) of points (n, 3) on the planes of faces (n,) with an area.

        Weights are at least 0, and their sum per point is 1.
        """
        tables = self._weight_rows.take(faces, axis=1)
        offsets = points.T - tables[6:]
        second, third = dot(tables[:3].T, offsets.T), dot(tables[3:6].T, offsets.T)
        weights = np.stack([1.0 - second - third, second, third])
        np.maximum(weights, 0.0, out=weights)
        weights /= weights[0] + weights[1] + weights[2]
        return weights.T

    @cached_property
    def _weight_rows(self) -> FloatArray:
        """Both slopes and the first corner of each face, shape (9, f), because NumPy gathers single numbers fastest."""
        slopes = self.slopes.reshape(-1, 6).T
        return np.ascontiguousarray(np.concatenate([slopes, self._corners[:, 0].T]))

    @cached_property
    def face_normal_rows(self) -> FloatArray:
        """Components of the unit normal of each face on the side of its winding, shape (3, f)."""
        return np.ascontiguousarray(self.surface.face_normals.T)

    @cached_property
    def slopes(self) -> FloatArray:
        """Gradients in space of the barycentric weights of the second and third corner of each face, shape (f, 2, 3)."""
        crosses = self.surface.face_crosses
        squares = dot(crosses, crosses)
        edges = self._corners[:, 1:] - self._corners[:, :1]
        slopes = np.stack([cross(edges[:, 1], crosses), cross(crosses, edges[:, 0])], axis=1)
        return np.divide(
            slopes,
            squares[:, None, None],
            out=np.zeros_like(slopes),
            where=squares[:, None, None] > 0,
        )

    def winding_numbers(self, origins: FloatArray, directions: FloatArray) -> IntArray:
        """Compute the winding number (n,) of the origin of each ray: faces that it leaves through minus faces it enters.

        For a closed surface with consistent windings, this is the number of solids around the origin; 0 is outside.
        Faces are found in float32. A face that is hit on its edge may count twice.
        """
        rays, faces = self._scene.crossings(_as_float32(origins, directions))
        leaving = np.sign(dot(self._planes[faces], directions[rays]))
        return np.bincount(rays, leaving, minlength=len(origins)).astype(np.int64)

    def nearest(self, points: FloatArray) -> tuple[FloatArray, IntArray]:
        """Return the nearest points (n, 3) on the surface to points (n, 3), and their faces (n,), found in float32."""
        faces = self._scene.nearest_faces(points)
        return nearest_on(self._corners[faces], points), faces

    def _cast(self, origins: FloatArray, directions: FloatArray) -> tuple[Hits, BoolArray]:
        """Return the hits of rays, and whether each hit is doubtful: float32 may have found the wrong face."""
        faces, second, third = self._scene.first_faces(_as_float32(origins, directions))
        hit = faces != MISS
        planes = self._plane_rows.take(faces, axis=1)
        along = dot(planes.T, directions)
        distance = np.full(len(faces), np.inf)
        met = hit & (along != 0)
        np.divide(planes[3] - dot(planes.T, origins), along, out=distance, where=met)
        least_weight = np.minimum(np.minimum(second, third), 1 - second - third)
        length = np.sqrt(dot(directions, directions))
        doubtful = hit & (least_weight * np.abs(along) < planes[4] * length)
        return Hits(distance, faces), doubtful

    def _recompute(self, origins: FloatArray, directions: FloatArray, first: Hits) -> Hits:
        """Compute the first hit of each ray in float64, among the faces that nearby rays hit."""
        candidates = self._faces_around(origins, directions)
        exact = self._nearest_of(candidates, origins, directions)
        at_corners = self._corner_pairs(candidates, origins, directions)
        _put_nearer(exact, *self._nearest_pairs(at_corners, origins, directions))
        # Faces may be smaller than the bundle. If all rays of the bundle hit, the first hit is kept.
        keeps_first = ~exact.hit & np.isfinite(first.distance) & (candidates != MISS).all(axis=1)
        return Hits(
            np.where(keeps_first, first.distance, exact.distance),
            np.where(keeps_first, first.face, exact.face),
        )

    def _nearest_pairs(
        self, pairs: Pairs, origins: FloatArray, directions: FloatArray
    ) -> tuple[NDArray[np.intp], Hits]:
        """Return the rays that hit a face of their pairs, ascending, and the first hit of each."""
        no_rays = np.zeros(0, np.int64)
        hit_rays, hit_blocks = [no_rays], [Hits(np.zeros(0), no_rays)]
        for rays, faces in pairs:
            block_hits = self._nearest_of(faces[:, None], origins[rays], directions[rays])
            hit_rays.append(rays[block_hits.hit])
            hit_blocks.append(_take(block_hits, block_hits.hit))
        rays, hits = np.concatenate(hit_rays), _join(hit_blocks)
        order = np.lexsort((hits.face, hits.distance, rays))
        _, first = np.unique(rays[order], return_index=True)
        return rays[order[first]], _take(hits, order[first])

    @cached_property
    def _faces_of_vertices(self) -> tuple[IntArray, IntArray, IntArray]:
        """Vertex indices (f, 3) after merging equal positions, start of each vertex in a list of faces, and the list."""
        _, corners = np.unique(self._corners.reshape(-1, 3), axis=0, return_inverse=True)
        corners = corners.reshape(-1)
        order = np.argsort(corners, kind="stable")
        starts = np.searchsorted(corners[order], np.arange(corners.max(initial=-1) + 2))
        return corners.reshape(-1, 3), starts, order // 3

    def _corner_pairs(
        self, candidates: IntArray, origins: FloatArray, directions: FloatArray
    ) -> Pairs:
        """Yield rays near a corner of a candidate, with all faces at this corner, because the bundle may miss some."""
        offsets = cross(
            self._corners[candidates] - origins[:, None, None], directions[:, None, None]
        )
        reach = (LATERAL_ERROR + _BUNDLE_RADIUS) ** 2 * dot(directions, directions)
        near = dot(offsets, offsets) < reach[:, None, None]
        rays, candidate, corner = np.nonzero(near & (candidates != MISS)[..., None])
        if not len(rays):
            return
        corners, starts, faces = self._faces_of_vertices
        pairs = np.unique(np.stack([rays, corners[candidates[rays, candidate], corner]]), axis=1)
        starts, ends = starts[pairs[1]], starts[pairs[1] + 1]
        pair_rays, positions = repeat_with_ranges(pairs[0], starts, ends - starts)
        yield pair_rays, faces[positions]

    @cached_property
    def _twins(self) -> tuple[IntArray, IntArray]:
        """Twins (faces that lie on each other): start of each face in a list of twins, shape (f + 1,), and the list."""
        pairs = overlapping_faces(self.surface, _DEPTH_ERROR)
        return np.searchsorted(pairs[:, 0], np.arange(len(self.surface.faces) + 1)), pairs[:, 1]

    @cached_property
    def _twin_counts(self) -> IntArray:
        """Number of twins of each face, shape (f + 1,); the last number, 0, is for `MISS`."""
        return np.append(np.diff(self._twins[0]), 0)

    def _twin_pairs(self, faces: IntArray) -> Pairs:
        """Yield blocks of rays and twins of the faces that they hit, `faces` (n,)."""
        starts, twins = self._twins
        if not len(twins):
            return
        counts = self._twin_counts.take(faces)
        rays = np.flatnonzero(counts)
        for block in blocks_by_count(rays, counts[rays], _MOST_PAIRS):
            pair_rays, positions = repeat_with_ranges(block, starts[faces[block]], counts[block])
            yield pair_rays, twins[positions]

    def _narrow_pairs(self, origins: FloatArray, directions: FloatArray) -> Pairs:
        """Yield blocks of rays and narrow faces near the rays."""
        if not len(self._narrow):
            return
        rays = _as_float32(origins, directions)
        counts = self._around_narrow.count_crossings(rays)
        near = np.flatnonzero(counts)
        for block in blocks_by_count(near, counts[near], _MOST_PAIRS):
            if not len(block):
                continue
            block_rays, box_faces = self._around_narrow.crossings(rays[block])
            pairs = np.unique(block_rays * len(self._narrow) + box_faces // len(_BOX_FACES))
            yield block[pairs // len(self._narrow)], self._narrow[pairs % len(self._narrow)]

    def _nearest_of(
        self, candidates: IntArray, origins: FloatArray, directions: FloatArray
    ) -> Hits:
        """Compute the first hit of each of m rays among its candidate faces (m, c), in float64."""
        corners = self._corners[candidates] - origins[:, None, None, :]
        # The two faces at an edge compute exactly opposite numbers, so no ray passes between them. At a vertex
        # rounding decides, so every face within the rounding error counts.
        sides = cross(corners, corners[:, :, [1, 2, 0]])
        sides = dot(sides, directions[:, None, None])
        farthest = dot(corners, corners).max(axis=2, keepdims=True)
        slack = _ROUNDING * farthest * np.sqrt(dot(directions, directions))[:, None, None]
        planes = self._planes[candidates]
        above = planes[..., 3] - dot(planes, origins[:, None])
        along = dot(planes, directions[:, None])
        inside = (sides >= -slack).all(axis=2) | (sides <= slack).all(axis=2)
        inside &= (candidates != MISS) & (along != 0)
        distances = np.divide(above, along, out=np.full(above.shape, np.inf), where=inside)
        distances[distances < 0] = np.inf

        # Of equal distances, the lowest face index wins, so that the hit depends only on the ray.
        nearest = np.lexsort((candidates, distances), axis=1)[:, :1]
        distance = np.take_along_axis(distances, nearest, axis=1)[:, 0]
        face = np.take_along_axis(candidates, nearest, axis=1)[:, 0]
        return Hits(distance, np.where(np.isfinite(distance), face, MISS))

    def _faces_around(self, origins: FloatArray, directions: FloatArray) -> IntArray:
        least = np.eye(3)[np.argmin(np.abs(directions), axis=1)]
        first = _unit(cross(directions, least))
        second = _unit(cross(directions, first))
        spread = _BUNDLE_RADIUS * (
            _BUNDLE[:, 0, None] * first[:, None, :] + _BUNDLE[:, 1, None] * second[:, None, :]
        )
        around = (origins[:, None, :] + spread).reshape(-1, 3)
        hits, _ = self._cast(around, np.repeat(directions, len(_BUNDLE), axis=0))
        return hits.face.reshape(-1, len(_BUNDLE))


def _as_float32(origins: FloatArray, directions: FloatArray) -> NDArray[np.float32]:
    rays = np.empty((len(origins), 6), dtype=np.float32)
    # Column by column, because inner loops of length three are slow.
    for axis in range(3):
        rays[:, axis] = origins[:, axis]
        rays[:, 3 + axis] = directions[:, axis]
    return rays


def _face_planes(surface: Surface) -> FloatArray:
    """Return normal (not of unit length), offset, and width of the edge band of each face, shape (f, 5)."""
    # The distance of a point from the nearest edge is at least (least barycentric weight) × (twice the area) /
    # (longest edge). `RayCaster` compares this with `LATERAL_ERROR`, multiplied by the longest edge.
    corners, crosses = surface.triangles, surface.face_crosses
    edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    offsets = dot(crosses, corners[:, 0])
    return np.column_stack([crosses, offsets, LATERAL_ERROR * edges.max(axis=1)])


def _boxes_around(triangles: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return vertices and faces of a closed box around the longest edge of each narrow triangle."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    rows = np.arange(len(triangles))
    longest = np.linalg.norm(edges, axis=2).argmax(axis=1)
    edge = edges[rows, longest]
    along = _unit(edge)
    across = _unit(cross(along, np.eye(3)[np.argmin(np.abs(along), axis=1)]))
    axes = np.stack(
        [
            edge + 2 * _BOX_MARGIN * along,
            2 * _BOX_MARGIN * across,
            2 * _BOX_MARGIN * cross(along, across),
        ],
        axis=1,
    )
    centres = triangles[rows, longest] + 0.5 * edge
    vertices = centres[:, None] + np.einsum("ca,nad->ncd", _BOX_CORNERS, axes)
    faces = _BOX_FACES + len(_BOX_CORNERS) * rows[:, None, None]
    return vertices.reshape(-1, 3), faces.reshape(-1, 3)


def _put(hits: Hits, rays: NDArray[np.intp], new_hits: Hits) -> None:
    hits.distance[rays] = new_hits.distance
    hits.face[rays] = new_hits.face


def _put_nearer(hits: Hits, rays: NDArray[np.intp], candidates: Hits) -> None:
    """Replace hits by candidates that are nearer, or equally near on a face with a lower index."""
    current = _take(hits, rays)
    equal = candidates.distance == current.distance
    nearer = (candidates.distance < current.distance) | (equal & (candidates.face < current.face))
    _put(hits, rays[nearer], _take(candidates, nearer))


def _join(parts: list[Hits]) -> Hits:
    return Hits(
        np.concatenate([part.distance for part in parts]),
        np.concatenate([part.face for part in parts]),
    )


def _take(hits: Hits, rays: NDArray[np.intp] | BoolArray) -> Hits:
    return Hits(hits.distance[rays], hits.face[rays])


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    # A vector of length 0 stays 0 instead of NaN.
    return vectors / np.where(lengths > 0, lengths, 1.0)
