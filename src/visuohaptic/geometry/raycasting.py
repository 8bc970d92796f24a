"""Cast rays at a triangle surface with Embree, and compute hits in float64.

Embree finds the first face of a ray in float32; the distance is computed in float64 from the plane of that face. Both
sides of a face count. On a surface of unit size, within about 1e-7 of an edge, Embree may return a wrong face, or
different faces on different processors. It also misses faces narrower than 1e-7. Doubtful rays, within
`LATERAL_ERROR` of an edge, are recomputed in float64, with these rules:

- A ray through an edge or a vertex may hit any of the faces that meet there. Each face gives a distance: from the
  origin to its plane, along the ray. The face with the smallest distance is hit.
- A ray through faces that lie on each other hits the face with the smallest distance.
- Of equal distances, the face with the lowest index is hit.
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
from visuohaptic.geometry.cast_rays import RayScene
from visuohaptic.geometry.nearest import nearest_on
from visuohaptic.geometry.overlaps import blocks_by_count, overlapping_faces, repeat_with_ranges
from visuohaptic.geometry.scenes import SCENES, installed_package
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.vectors import cross, dot

MISS = -1

Pairs = Iterator[tuple[IntArray, IntArray]]
"""Blocks of pairs of a ray and a face that it may hit: ray indices (k,), ascending, and face indices (k,)."""

Suspects = Callable[[FloatArray], BoolArray]
"""A function that takes the distances (n,) of a first cast, and returns which rays to recompute in float64, (n,)."""

# Largest error of Embree's float32 across a ray, in units of the surface: eight roundings of coordinates
# of size 3. Rays within this distance of an edge are doubtful.
LATERAL_ERROR = 2e-6
# A doubtful ray gets a bundle of parallel rays, which find candidate faces: itself, and eight rays up to this distance
# from it (units of the surface).
_BUNDLE_RADIUS = 3e-6
_BUNDLE = np.array(
    [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1], [0.7, 0.7], [-0.7, 0.7], [-0.7, -0.7], [0.7, -0.7]]
)
# Another face than the face of float32 is the nearest only if nearer by more than this (units of the surface).
_NEARER = 1e-9
# Rounding of a triple product of float64 vectors, relative to their lengths.
_ROUNDING = 2e-15
# A face is narrow if its height above its longest edge is below this (units of the surface). It may lie between the
# rays of a bundle, and float32 may miss it.
_NARROW = 2 * (LATERAL_ERROR + _BUNDLE_RADIUS)
# Of two faces closer than this (units of the surface), float32 may find the farther face.
_DEPTH_ERROR = 4e-6
# A face with a smaller ratio of height to longest edge is a line in float64, and does not count as narrow.
_LINE_RATIO = 1e-12
# Rays within about this distance of the longest edge of a narrow face are compared with the face.
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
        Hits are at origin + distance × direction; infinite for a miss. The unit is the length of the ray's direction.
        A ray that starts on the surface may hit the surface there, at a distance of about 0, above or below.
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
        The surface. Its vertices should lie within about 1 of the origin, because faces are found in float32.
    package : str, optional
        Python package that calls Embree, a key of `scenes.SCENES`; by default the first of these that is installed.

    Attributes
    ----------
    surface : Surface
        The surface as given.
    bounds : ndarray of shape (2, 3)
        Lower and upper corner of the bounding box.
    """

    def __init__(self, surface: Surface, package: str | None = None) -> None:
        self.surface = surface
        self.bounds = np.stack([surface.vertices.min(axis=0), surface.vertices.max(axis=0)])
        self._corners = surface.triangles
        self._planes = _face_planes(surface)
        # Height above the longest edge is twice the area divided by this edge. Both are scaled by `LATERAL_ERROR`.
        double_areas = LATERAL_ERROR * np.linalg.norm(surface.face_crosses, axis=1)
        # Transposed for casts: NumPy gathers single numbers fastest.
        self._plane_rows = np.ascontiguousarray(self._planes.T)
        longest = self._planes[:, 4]
        self._narrow = np.flatnonzero(
            (double_areas < _NARROW * longest) & (double_areas > _LINE_RATIO * longest)
        )
        make_scene = SCENES[package or installed_package()]
        self._scene: RayScene = make_scene(surface.vertices, surface.faces)
        if len(self._narrow):
            boxes = _boxes_around(self._corners[self._narrow])
            self._around_narrow: RayScene = make_scene(*boxes)

    @property
    def reach(self) -> float:
        """Diagonal of the bounding box: an upper bound of the distance between points of the surface."""
        diagonal = self.bounds[1] - self.bounds[0]
        return float(np.sqrt(dot(diagonal, diagonal)))

    def first_hits(
        self, origins: FloatArray, directions: FloatArray, suspects: Suspects | None = None
    ) -> Hits:
        """Compute the first hit of each ray on either side of a face, with the same bits on every x86-64 processor.

        Rays that hit near an edge or vertex, or at a grazing angle, are recomputed in float64, because float32 may
        have found the wrong face. A ray that misses is only compared with narrow faces, unless `suspects` returns it.

        Parameters
        ----------
        origins, directions : ndarray of shape (n, 3)
            Origin and direction of each ray; directions may have any length above 0.
        suspects : callable, optional
            Function of the distances (n,) of the first cast, infinite for a miss. Returns which rays are recomputed
            too, (n,), bool; for example rays that miss while all rays around them hit. Without `suspects`, the
            hit of a ray does not depend on the other rays.

        Returns
        -------
        Hits
            First hit of each ray.
        """
        hits, doubtful = self._cast(origins, directions)
        if suspects is not None:
            doubtful |= suspects(hits.distance)
        narrow_rays, narrow_hits = self._first_of_pairs(
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
        twins = self._first_of_pairs(self._twin_pairs(hits.face), origins, directions)
        _put_nearer(hits, *twins)
        return hits

    def weights(self, points: FloatArray, faces: IntArray) -> FloatArray:
        """Compute the barycentric weights (n, 3) of points (n, 3), each in the plane of its face, `faces` (n,).

        A point outside its face has negative weights; these become 0, and the weights of the point are divided by
        their sum. Each face must have an area above 0.
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
        """Both `weight_gradients` (rows 0 to 5) and first corner (rows 6 to 8) of each face; this layout is fastest."""
        gradients = self.weight_gradients.reshape(-1, 6).T
        return np.ascontiguousarray(np.concatenate([gradients, self._corners[:, 0].T]))

    @cached_property
    def face_normal_rows(self) -> FloatArray:
        """Rows x, y, z of `Surface.face_normals`, shape (3, f); zero for a face without area."""
        return np.ascontiguousarray(self.surface.face_normals.T)

    @cached_property
    def weight_gradients(self) -> FloatArray:
        """Gradients of the barycentric weights of the second and third corner of each face, shape (f, 2, 3).

        The unit is one over a length. A gradient lies in the plane of its face, and is zero for a face without area.
        """
        crosses = self.surface.face_crosses
        squares = dot(crosses, crosses)
        edges = self._corners[:, 1:] - self._corners[:, :1]
        scaled = np.stack([cross(edges[:, 1], crosses), cross(crosses, edges[:, 0])], axis=1)
        return np.divide(
            scaled,
            squares[:, None, None],
            out=np.zeros_like(scaled),
            where=squares[:, None, None] > 0,
        )

    def winding_numbers(self, origins: FloatArray, directions: FloatArray) -> IntArray:
        """Compute the winding number (n,) of each ray's origin: faces where the ray leaves minus faces where it enters.

        A ray leaves through a face if its direction is on the side of the face's normal. For closed solids with
        normals outwards, the winding number is the number of solids around the origin, whatever the direction;
        with normals inwards, it is minus this number. Faces are found in float32. A ray through the edge between two
        faces may count both, and the number is then wrong by 1.
        """
        rays, faces = self._scene.crossings(_as_float32(origins, directions))
        leaving = np.sign(dot(self._planes[faces], directions[rays]))
        return np.bincount(rays, leaving, minlength=len(origins)).astype(np.int64)

    def nearest(self, points: FloatArray) -> tuple[FloatArray, IntArray]:
        """Return the point on the surface nearest to each point, (n, 3) to (n, 3), and the index (n,) of its face.

        Open3D finds a face in float32. Beside long thin faces this may be a neighbour of the nearest face, so that all
        faces at the corners of the face are compared in float64. Of equally near faces any may be returned.
        """
        found = self._scene.nearest_faces(points)
        corners, starts, faces_of_corners = self._faces_of_vertices
        corner = corners[found].reshape(-1)
        rows, positions = repeat_with_ranges(
            np.repeat(np.arange(len(points)), 3),
            starts[corner],
            starts[corner + 1] - starts[corner],
        )
        faces = faces_of_corners[positions]
        locations = nearest_on(self._corners[faces], points[rows])
        distances = np.linalg.norm(locations - points[rows], axis=1)
        distances[faces != found[rows]] += _NEARER
        order = np.lexsort((faces, distances, rows))
        chosen = order[np.unique(rows[order], return_index=True)[1]]
        return locations[chosen], faces[chosen]

    def _cast(self, origins: FloatArray, directions: FloatArray) -> tuple[Hits, BoolArray]:
        """Return hits on the faces that float32 finds, and which hits are doubtful: their face may be wrong, (n,)."""
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
        """Compute the first hit of each ray in float64, among faces that its bundle hits and faces at their corners."""
        candidates = self._faces_around(origins, directions)
        exact = self._first_of_candidates(candidates, origins, directions)
        at_corners = self._corner_pairs(candidates, origins, directions)
        _put_nearer(exact, *self._first_of_pairs(at_corners, origins, directions))
        # A face that is smaller than the bundle may be no candidate. So the hit of the first cast is kept if no
        # candidate is hit, although all rays of the bundle hit the surface.
        keeps_first = ~exact.hit & np.isfinite(first.distance) & (candidates != MISS).all(axis=1)
        return Hits(
            np.where(keeps_first, first.distance, exact.distance),
            np.where(keeps_first, first.face, exact.face),
        )

    def _first_of_pairs(
        self, pairs: Pairs, origins: FloatArray, directions: FloatArray
    ) -> tuple[NDArray[np.intp], Hits]:
        """Return the indices of rays that hit a face of their pairs, ascending, and the first hit of each."""
        no_rays = np.zeros(0, np.int64)
        hit_rays, hit_blocks = [no_rays], [Hits(np.zeros(0), no_rays)]
        for rays, faces in pairs:
            block_hits = self._first_of_candidates(faces[:, None], origins[rays], directions[rays])
            hit_rays.append(rays[block_hits.hit])
            hit_blocks.append(_take(block_hits, block_hits.hit))
        rays, hits = np.concatenate(hit_rays), _join(hit_blocks)
        order = np.lexsort((hits.face, hits.distance, rays))
        _, first = np.unique(rays[order], return_index=True)
        return rays[order[first]], _take(hits, order[first])

    @cached_property
    def _faces_of_vertices(self) -> tuple[IntArray, IntArray, IntArray]:
        """Vertex indices (f, 3), equal positions merged; starts (v + 1,) per vertex in a list of faces; the list."""
        _, corners = np.unique(self._corners.reshape(-1, 3), axis=0, return_inverse=True)
        corners = corners.reshape(-1)
        order = np.argsort(corners, kind="stable")
        starts = np.searchsorted(corners[order], np.arange(corners.max(initial=-1) + 2))
        return corners.reshape(-1, 3), starts, order // 3

    def _corner_pairs(
        self, candidates: IntArray, origins: FloatArray, directions: FloatArray
    ) -> Pairs:
        """Yield one block of rays near a corner of their candidates (m, c), paired with all faces at this corner."""
        # The bundle may miss some faces at a corner.
        offsets = cross(
            self._corners[candidates] - origins[:, None, None], directions[:, None, None]
        )
        limits = (LATERAL_ERROR + _BUNDLE_RADIUS) ** 2 * dot(directions, directions)
        near = dot(offsets, offsets) < limits[:, None, None]
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
        """Starts (f + 1,) of the faces in a list of twins, and the list; twins are faces that lie on each other."""
        pairs = overlapping_faces(self.surface, _DEPTH_ERROR)
        return np.searchsorted(pairs[:, 0], np.arange(len(self.surface.faces) + 1)), pairs[:, 1]

    @cached_property
    def _twin_counts(self) -> IntArray:
        """Number of twins of each face, shape (f + 1,); the last number, 0, is for `MISS`."""
        return np.append(np.diff(self._twins[0]), 0)

    def _twin_pairs(self, faces: IntArray) -> Pairs:
        """Yield blocks of rays, paired with the twins of the faces (n,) that the rays hit; `MISS` has no twin."""
        starts, twins = self._twins
        if not len(twins):
            return
        counts = self._twin_counts.take(faces)
        rays = np.flatnonzero(counts)
        for block in blocks_by_count(rays, counts[rays], _MOST_PAIRS):
            pair_rays, positions = repeat_with_ranges(block, starts[faces[block]], counts[block])
            yield pair_rays, twins[positions]

    def _narrow_pairs(self, origins: FloatArray, directions: FloatArray) -> Pairs:
        """Yield blocks of rays, paired with the narrow faces within about `_BOX_MARGIN` of the rays."""
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

    def _first_of_candidates(
        self, candidates: IntArray, origins: FloatArray, directions: FloatArray
    ) -> Hits:
        """Compute the first hit of each of m rays among its candidates, face indices or `MISS` (m, c), in float64."""
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
        """Return the faces that the nine rays of each ray's bundle hit, or `MISS`, (n, 9)."""
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
    """Return the rays that scenes take: origin and direction, shape (n, 6)."""
    rays = np.empty((len(origins), 6), dtype=np.float32)
    # Column by column, because inner loops of length three are slow.
    for axis in range(3):
        rays[:, axis] = origins[:, axis]
        rays[:, 3 + axis] = directions[:, axis]
    return rays


def _face_planes(surface: Surface) -> FloatArray:
    """Return normal n (twice the area long), n · corner, and `LATERAL_ERROR` × longest edge of each face, (f, 5)."""
    # The distance of a point from the nearest edge is at least (least barycentric weight) × (twice the area) /
    # (longest edge). `RayCaster` compares this distance with `LATERAL_ERROR`, both sides times the longest edge.
    corners, crosses = surface.triangles, surface.face_crosses
    edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    offsets = dot(crosses, corners[:, 0])
    return np.column_stack([crosses, offsets, LATERAL_ERROR * edges.max(axis=1)])


def _boxes_around(triangles: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return vertices (8 k, 3) and faces (12 k, 3) of closed boxes, each around the longest edge of a triangle."""
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
    """Replace the hits of some rays in place."""
    hits.distance[rays] = new_hits.distance
    hits.face[rays] = new_hits.face


def _put_nearer(hits: Hits, rays: NDArray[np.intp], candidates: Hits) -> None:
    """Replace the hits of some rays in place by candidates that are nearer; of equal distances the lower face stays."""
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
