"""Rays against a triangle surface, many at once, through Embree.

Embree says which face a ray meets first, in float32; float64 says where: on the plane of that face.
Embree may take the wrong face within about 1e-7 of an edge, takes another one on another processor,
and passes faces as narrow as that: such rays are settled in float64, by these rules.

- A ray through an edge or a vertex meets one of the faces there: the nearest of their planes along the
  ray and, of equally near ones, the face of the lowest number.
- A ray through faces that lie on each other meets the nearest of them, of equally near ones the lowest number.
- A ray that lies in the plane of a face does not meet that face, but those beside it.
- A face without area is met by no ray.
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
from visuohaptic.geometry.overlaps import in_parts, overlapping_faces, paired
from visuohaptic.geometry.scenes import SCENES, installed_package
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.vectors import cross, dot

MISS = -1

Pairs = Iterator[tuple[IntArray, IntArray]]
"""Rays, ascending, each with a face that it may meet, some at a time."""

Suspects = Callable[[FloatArray], BoolArray]

# Embree's float32 may take a ray this far (in the surface's unit) to the wrong side of an edge:
# eight roundings of coordinates of size 3.
LATERAL_ERROR = 2e-6
# Rays that look for candidate faces around a doubtful ray are offset by this distance.
_BUNDLE_RADIUS = 3e-6
_BUNDLE = np.array(
    [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1], [0.7, 0.7], [-0.7, 0.7], [-0.7, -0.7], [0.7, -0.7]]
)
# Rounding of a triple product of float64 vectors, relative to their lengths.
_ROUNDING = 2e-15
# A face this high may lie between the rays of a bundle, and float32 may take the one at its middle past it.
_NARROW = 2 * (LATERAL_ERROR + _BUNDLE_RADIUS)
# Of faces that lie on each other, float32 may take the one behind, this far in the surface's unit.
_DEPTH_ERROR = 4e-6
# A face lower than this is a line in float64, too.
_LINE = 1e-12
# Only rays that come so near to a narrow face are compared with it.
_ROOM = 1e-4
# Pairs of a ray and a face, or a box around one, that are compared at once, for the memory that they take.
_PAIRS = 1 << 16
# Corners and faces of a cube about the origin, whose edges are 1.
_BOX_CORNERS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
_BOX_FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)


@dataclass(frozen=True)
class Hits:
    """Where each of n rays first meets the surface.

    `distance` (n,), float64, is along the ray in lengths of its direction, infinite for a miss;
    `face` (n,), int64, is the face that was hit, or `MISS`.
    """

    distance: FloatArray
    face: IntArray

    @property
    def hit(self) -> BoolArray:
        """Whether each ray met the surface, shape (n,)."""
        return self.face != MISS


class RayCaster:
    """A surface prepared for rays; `bounds` (2, 3) are the lower and upper corner of its bounding box.

    Keep it near the origin and near unit size, for faces are found in float32. Of `scenes.SCENES`
    the one that is named by `package` casts the rays, or else the first one that is installed.
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
        """A length that no two points of the surface are farther apart than."""
        across = self.bounds[1] - self.bounds[0]
        return float(np.sqrt(dot(across, across)))

    def first_hits(
        self, origins: FloatArray, directions: FloatArray, suspects: Suspects | None = None
    ) -> Hits:
        """Cast rays (n, 3) and give the first hit of each, the same bits on every x86-64 processor.

        Doubtful is a ray that meets its face so near an edge or vertex, or so grazing, that float32 may
        have taken the wrong face; and all that `suspects` names, such as a miss between hits: it
        takes the distances (n,) of the first cast and gives further doubtful rays (n,), bool. These
        are settled in float64. A ray's hit is independent of what else is in the batch as far as
        `suspects` is.
        """
        hits, doubtful = self._cast(origins, directions)
        if suspects is not None:
            doubtful |= suspects(hits.distance)
        narrow_rays, narrow = self._nearest_pairs(
            self._narrow_pairs(origins, directions), origins, directions
        )
        # A doubtful face is not kept where the ray meets another one for sure.
        unsure = narrow_rays[doubtful[narrow_rays]]
        hits.distance[unsure], hits.face[unsure] = np.inf, MISS
        again = np.flatnonzero(doubtful)
        if len(again):
            first = _take(hits, again)
            _put(hits, again, self._settle(origins[again], directions[again], first))
        nearer = narrow.distance < hits.distance[narrow_rays]
        _put(hits, narrow_rays[nearer], _take(narrow, nearer))
        twins = self._nearest_pairs(self._twin_pairs(hits.face), origins, directions)
        _put_nearer(hits, *twins)
        return hits

    def weights(self, points: FloatArray, faces: IntArray) -> FloatArray:
        """Give barycentric weights (n, 3) of points (n, 3), each on the plane of its face, which has an area.

        They are at least 0, and a point's sum is 1.
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
        """Both slopes and the first corner of each face, shape (9, f): NumPy gathers single numbers fastest."""
        slopes = self.slopes.reshape(-1, 6).T
        return np.ascontiguousarray(np.concatenate([slopes, self._corners[:, 0].T]))

    @cached_property
    def face_normal_rows(self) -> FloatArray:
        """Components of the unit normal of each face by its winding, shape (3, f)."""
        return np.ascontiguousarray(self.surface.face_normals.T)

    @cached_property
    def slopes(self) -> FloatArray:
        """How the weights of each face's second and third corner grow in space, shape (f, 2, 3)."""
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
        """Count in how many solids each ray begins: faces by which it leaves less those by which it enters.

        Of a closed surface whose faces are wound alike it is the winding number of the origin, 0
        outside of all solids. Faces are found in float32; one that is met on its edge may count
        twice.
        """
        which, faces = self._scene.crossings(_as_float32(origins, directions))
        leaving = np.sign(dot(self._planes[faces], directions[which]))
        return np.bincount(which, leaving, minlength=len(origins)).astype(np.int64)

    def nearest(self, points: FloatArray) -> tuple[FloatArray, IntArray]:
        """Give the surface's nearest points (n, 3) to points (n, 3), and their faces (n,), found in float32."""
        faces = self._scene.nearest_faces(points)
        return nearest_on(self._corners[faces], points), faces

    def _cast(self, origins: FloatArray, directions: FloatArray) -> tuple[Hits, BoolArray]:
        """Cast rays once: their hits, and which of them float32 may have given the wrong face."""
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

    def _settle(self, origins: FloatArray, directions: FloatArray, first: Hits) -> Hits:
        """Choose each ray's face in float64, among those that rays close by meet."""
        candidates = self._faces_around(origins, directions)
        exact = self._nearest_of(candidates, origins, directions)
        at_corners = self._corner_pairs(candidates, origins, directions)
        _put_nearer(exact, *self._nearest_pairs(at_corners, origins, directions))
        # Among faces smaller than the bundle none may be found, though no ray gets through.
        kept = ~exact.hit & np.isfinite(first.distance) & (candidates != MISS).all(axis=1)
        return Hits(
            np.where(kept, first.distance, exact.distance),
            np.where(kept, first.face, exact.face),
        )

    def _nearest_pairs(
        self, pairs: Pairs, origins: FloatArray, directions: FloatArray
    ) -> tuple[NDArray[np.intp], Hits]:
        """Give the rays that meet a face of their pairs, ascending, and where each meets the first of them."""
        nothing = np.zeros(0, np.int64)
        met_rays, met = [nothing], [Hits(np.zeros(0), nothing)]
        for rays, faces in pairs:
            found = self._nearest_of(faces[:, None], origins[rays], directions[rays])
            met_rays.append(rays[found.hit])
            met.append(_take(found, found.hit))
        rays, hits = np.concatenate(met_rays), _join(met)
        order = np.lexsort((hits.face, hits.distance, rays))
        _, first = np.unique(rays[order], return_index=True)
        return rays[order[first]], _take(hits, order[first])

    @cached_property
    def _faces_at(self) -> tuple[IntArray, IntArray, IntArray]:
        """Number each face's corners by their places, (f, 3); where a place's faces begin in a list; and the list."""
        _, corners = np.unique(self._corners.reshape(-1, 3), axis=0, return_inverse=True)
        corners = corners.reshape(-1)
        order = np.argsort(corners, kind="stable")
        starts = np.searchsorted(corners[order], np.arange(corners.max(initial=-1) + 2))
        return corners.reshape(-1, 3), starts, order // 3

    def _corner_pairs(
        self, candidates: IntArray, origins: FloatArray, directions: FloatArray
    ) -> Pairs:
        """Give rays that pass a corner of a candidate, and all faces there, of which a bundle may have missed some."""
        offsets = cross(
            self._corners[candidates] - origins[:, None, None], directions[:, None, None]
        )
        reach = (LATERAL_ERROR + _BUNDLE_RADIUS) ** 2 * dot(directions, directions)
        near = dot(offsets, offsets) < reach[:, None, None]
        rays, which, corner = np.nonzero(near & (candidates != MISS)[..., None])
        if not len(rays):
            return
        corners, starts, faces = self._faces_at
        pairs = np.unique(np.stack([rays, corners[candidates[rays, which], corner]]), axis=1)
        starts, ends = starts[pairs[1]], starts[pairs[1] + 1]
        met, places = paired(pairs[0], starts, ends - starts)
        yield met, faces[places]

    @cached_property
    def _twins(self) -> tuple[IntArray, IntArray]:
        """Each face's twins, which lie on it: where they begin in a list of faces, shape (f + 1,), and the list."""
        pairs = overlapping_faces(self.surface, _DEPTH_ERROR)
        return np.searchsorted(pairs[:, 0], np.arange(len(self.surface.faces) + 1)), pairs[:, 1]

    @cached_property
    def _twin_counts(self) -> IntArray:
        """How many twins each face has, shape (f + 1,); the last number is that of `MISS`."""
        return np.append(np.diff(self._twins[0]), 0)

    def _twin_pairs(self, met: IntArray) -> Pairs:
        """Give rays and the twins of the faces that they met, some pairs at a time."""
        starts, twins = self._twins
        if not len(twins):
            return
        counts = self._twin_counts.take(met)
        rays = np.flatnonzero(counts)
        for part in in_parts(rays, counts[rays], _PAIRS):
            again, places = paired(part, starts[met[part]], counts[part])
            yield again, twins[places]

    def _narrow_pairs(self, origins: FloatArray, directions: FloatArray) -> Pairs:
        """Give rays and the narrow faces that they come near to, some pairs at a time."""
        if not len(self._narrow):
            return
        rays = _as_float32(origins, directions)
        counts = self._around_narrow.count_crossings(rays)
        near = np.flatnonzero(counts)
        for part in in_parts(near, counts[near], _PAIRS):
            if not len(part):
                continue
            which, met = self._around_narrow.crossings(rays[part])
            pairs = np.unique(which * len(self._narrow) + met // len(_BOX_FACES))
            yield part[pairs // len(self._narrow)], self._narrow[pairs % len(self._narrow)]

    def _nearest_of(
        self, candidates: IntArray, origins: FloatArray, directions: FloatArray
    ) -> Hits:
        """Meet each of m rays with its own candidates, shape (m, c), in float64."""
        corners = self._corners[candidates] - origins[:, None, None, :]
        # Two faces at an edge have exactly opposite numbers for it, so no ray slips between;
        # at a vertex rounding alone decides, and every face that it may have cut off counts.
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

        # Equal distances go to the lower face, so that the answer depends on the ray alone.
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
    # Column by column, for inner loops of three are slow.
    for axis in range(3):
        rays[:, axis] = origins[:, axis]
        rays[:, 3 + axis] = directions[:, axis]
    return rays


def _face_planes(surface: Surface) -> FloatArray:
    """Give normal (not unit), offset, and the edge band of each face, shape (f, 5)."""
    # The distance from a point to a face's nearest edge is at least its least barycentric weight ×
    # twice the area / the longest edge; `RayCaster` compares that with `LATERAL_ERROR` undivided.
    corners, crosses = surface.triangles, surface.face_crosses
    edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    offsets = dot(crosses, corners[:, 0])
    return np.column_stack([crosses, offsets, LATERAL_ERROR * edges.max(axis=1)])


def _boxes_around(triangles: FloatArray) -> tuple[FloatArray, IntArray]:
    """Give vertices and faces of a closed box along the longest edge of each narrow triangle."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    rows = np.arange(len(triangles))
    longest = np.linalg.norm(edges, axis=2).argmax(axis=1)
    edge = edges[rows, longest]
    along = _unit(edge)
    aside = _unit(cross(along, np.eye(3)[np.argmin(np.abs(along), axis=1)]))
    axes = np.stack(
        [edge + 2 * _ROOM * along, 2 * _ROOM * aside, 2 * _ROOM * cross(along, aside)], axis=1
    )
    centres = triangles[rows, longest] + 0.5 * edge
    vertices = centres[:, None] + np.einsum("ca,nad->ncd", _BOX_CORNERS, axes)
    faces = _BOX_FACES + len(_BOX_CORNERS) * rows[:, None, None]
    return vertices.reshape(-1, 3), faces.reshape(-1, 3)


def _put(hits: Hits, rays: NDArray[np.intp], others: Hits) -> None:
    hits.distance[rays] = others.distance
    hits.face[rays] = others.face


def _put_nearer(hits: Hits, rays: NDArray[np.intp], others: Hits) -> None:
    """Put hits where they are nearer, or as near on a face of a lower number."""
    now = _take(hits, rays)
    equal = others.distance == now.distance
    nearer = (others.distance < now.distance) | (equal & (others.face < now.face))
    _put(hits, rays[nearer], _take(others, nearer))


def _join(parts: list[Hits]) -> Hits:
    return Hits(
        np.concatenate([part.distance for part in parts]),
        np.concatenate([part.face for part in parts]),
    )


def _take(hits: Hits, rays: NDArray[np.intp] | BoolArray) -> Hits:
    return Hits(hits.distance[rays], hits.face[rays])


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    # A ray without direction goes nowhere; dividing by zero would make it NaN.
    return vectors / np.where(lengths > 0, lengths, 1.0)
