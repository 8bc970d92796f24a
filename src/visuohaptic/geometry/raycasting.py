"""Rays against a triangle surface, many at once, through Open3D's Embree scene.

Embree finds the face in float32; the distance to that face's plane is computed
again in float64. What is left of float32 is the choice of the face, which can be
wrong within about 1e-7 of an edge, and passes faces as narrow as that: `RayCaster.settled_hits`
looks at both again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.geometry.surface import Surface

MISS = -1

Suspects = Callable[[NDArray[np.float64]], NDArray[np.bool_]]

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
# A face lower than this is a line in float64, too.
_LINE = 1e-12
# Only rays that come so near to a narrow face are compared with it.
_ROOM = 1e-4
# Faces of the box around a narrow face that are met by the rays compared at once, for the memory that they take.
_PAIRS = 1 << 16
_BOX_FACES = 12


@dataclass(frozen=True)
class Hits:
    """Where each of n rays first meets the surface.

    Attributes
    ----------
    distance : numpy.ndarray
        Shape (n,), float64: along the ray in lengths of its direction; infinite for a miss.
    face : numpy.ndarray
        Shape (n,), int64: the face that was hit, or `MISS`.
    barycentric : numpy.ndarray
        Shape (n, 2), float64: weights of the face's second and third corner; zero for a miss.
    """

    distance: NDArray[np.float64]
    face: NDArray[np.int64]
    barycentric: NDArray[np.float64]

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Whether each ray met the surface, shape (n,)."""
        return self.face != MISS


class RayCaster:
    """A surface prepared for rays.

    Parameters
    ----------
    surface : Surface
        The surface; keep it near the origin and near unit size, for faces are
        found in float32.

    Attributes
    ----------
    surface : Surface
        The same surface.
    bounds : numpy.ndarray
        Shape (2, 3), float64: lower and upper corner of its bounding box.
    """

    def __init__(self, surface: Surface) -> None:
        from visuohaptic.geometry.compiled_open3d import open3d

        self.surface = surface
        self.bounds = np.stack([surface.vertices.min(axis=0), surface.vertices.max(axis=0)])
        self._corners = surface.triangles
        self._planes = _face_planes(surface)
        heights = LATERAL_ERROR * np.linalg.norm(surface.face_crosses, axis=1)
        longest = self._planes[:, 4]
        self._narrow = np.flatnonzero((heights < _NARROW * longest) & (heights > _LINE * longest))
        self._tensor = open3d.core.Tensor
        self._miss = open3d.t.geometry.RaycastingScene.INVALID_ID
        self._scene = self._make_scene(surface.vertices, surface.faces)
        if len(self._narrow):
            boxes = _boxes_around(self._corners[self._narrow])
            self._around_narrow = self._make_scene(*boxes)

    @property
    def reach(self) -> float:
        """A length that no two points of the surface are farther apart than."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))

    def first_hits(self, origins: NDArray[np.float64], directions: NDArray[np.float64]) -> Hits:
        """Cast rays and give the first hit of each.

        Parameters
        ----------
        origins, directions : numpy.ndarray
            Shape (n, 3) each; the frame and unit of the surface's vertices.

        Returns
        -------
        Hits
            One entry a ray; independent of what else is in the batch. Faces are
            found in float32, distances are to the face's plane in float64.
        """
        hits, _ = self._cast(origins, directions)
        return hits

    def first_faces(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """Cast rays and give the face that each meets first: `first_hits` of those that hit.

        Parameters
        ----------
        origins, directions : numpy.ndarray
            Shape (n, 3) each; the frame and unit of the surface's vertices.

        Returns
        -------
        rays : numpy.ndarray
            Shape (k,), int64: the rays that meet the surface, ascending.
        faces : numpy.ndarray
            Shape (k,), int64: the face that each meets.
        barycentric : numpy.ndarray
            Shape (k, 2), float64, as in `Hits`.
        """
        answer = self._embree(self._scene, origins, directions)
        faces = answer["primitive_ids"].numpy()
        rays = np.flatnonzero(faces != self._miss)
        barycentric = answer["primitive_uvs"].numpy().take(rays, axis=0)
        return rays, faces.take(rays).astype(np.int64), barycentric.astype(np.float64)

    def settled_hits(
        self,
        origins: NDArray[np.float64],
        directions: NDArray[np.float64],
        suspects: Suspects | None = None,
    ) -> Hits:
        """Cast rays, and cast the doubtful ones again in float64.

        Doubtful is a ray that meets its face so near an edge or vertex, or so
        grazing, that float32 may have taken the wrong face; and all that `suspects` names,
        such as a miss between hits. Every ray is compared in float64 with the faces that are too
        narrow for float32, if the surface has such.

        Parameters
        ----------
        origins, directions : numpy.ndarray
            Shape (n, 3) each; the frame and unit of the surface's vertices.
        suspects : callable, optional
            Takes the distances of the first cast, shape (n,), and gives further doubtful
            rays, shape (n,), bool.

        Returns
        -------
        Hits
            One entry a ray; independent of what else is in the batch as far as `suspects` is.
        """
        hits, doubtful = self._cast(origins, directions)
        if suspects is not None:
            doubtful |= suspects(hits.distance)
        narrow_rays, narrow = self._narrow_hits(origins, directions)
        # A doubtful face is not kept where the ray meets another one for sure.
        unsure = narrow_rays[doubtful[narrow_rays]]
        hits.distance[unsure], hits.face[unsure] = np.inf, MISS
        again = np.flatnonzero(doubtful)
        if len(again):
            first = _take(hits, again)
            _put(hits, again, self._settle(origins[again], directions[again], first))
        nearer = narrow.distance < hits.distance[narrow_rays]
        _put(hits, narrow_rays[nearer], _take(narrow, nearer))
        return hits

    def nearest(self, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Give the surface's nearest point to each point.

        Parameters
        ----------
        points : numpy.ndarray
            Shape (n, 3), float64; the frame and unit of the surface's vertices.

        Returns
        -------
        points : numpy.ndarray
            Shape (n, 3), float64, on the surface.
        faces : numpy.ndarray
            Shape (n,), int64: the face that each lies on, found in float32.
        """
        answer = self._scene.compute_closest_points(self._tensor(points.astype(np.float32)))
        faces = answer["primitive_ids"].numpy().astype(np.int64)
        second, third = answer["primitive_uvs"].numpy().astype(np.float64).T
        weights = np.stack([1 - second - third, second, third], axis=1)
        return np.einsum("nc,ncd->nd", weights, self._corners[faces]), faces

    def _cast(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> tuple[Hits, NDArray[np.bool_]]:
        answer = self._embree(self._scene, origins, directions)
        faces = answer["primitive_ids"].numpy()
        hit = faces != self._miss
        faces = faces.astype(np.int64)
        faces[~hit] = MISS
        weights = answer["primitive_uvs"].numpy()
        distance = answer["t_hit"].numpy().astype(np.float64)

        planes = self._planes.take(faces, axis=0)
        along = _dot(planes, directions)
        exact = hit & (along != 0)
        np.divide(planes[:, 3] - _dot(planes, origins), along, out=distance, where=exact)
        u, v = weights[:, 0], weights[:, 1]
        least_weight = np.minimum(np.minimum(u, v), 1 - u - v)
        length = np.sqrt(_dot(directions, directions))
        doubtful = hit & (least_weight * np.abs(along) < planes[:, 4] * length)
        hits = Hits(distance, faces, weights.astype(np.float64))
        return hits, doubtful

    def _make_scene(self, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> Any:
        from visuohaptic.geometry.compiled_open3d import open3d

        scene = open3d.t.geometry.RaycastingScene(nthreads=1)
        scene.add_triangles(
            self._tensor(np.ascontiguousarray(vertices, dtype=np.float32)),
            self._tensor(np.ascontiguousarray(faces, dtype=np.uint32)),
        )
        return scene

    def _embree(
        self, scene: Any, origins: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> dict[str, Any]:
        answer: dict[str, Any] = scene.cast_rays(self._tensor(_as_float32(origins, directions)))
        return answer

    def _settle(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64], first: Hits
    ) -> Hits:
        """Choose each ray's face in float64, among those that rays close by meet."""
        candidates = self._faces_around(origins, directions)
        exact = self._nearest_of(candidates, origins, directions)
        # Among faces smaller than the bundle none may be found, though no ray gets through.
        kept = ~exact.hit & first.hit & (candidates != MISS).all(axis=1)
        return Hits(
            np.where(kept, first.distance, exact.distance),
            np.where(kept, first.face, exact.face),
            np.where(kept[:, None], first.barycentric, exact.barycentric),
        )

    def _narrow_hits(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> tuple[NDArray[np.intp], Hits]:
        """Give the rays that meet narrow faces, ascending, and where each meets the first of them."""
        nothing = np.zeros(0, np.int64)
        no_hits = Hits(np.zeros(0), nothing, np.zeros((0, 2)))
        if not len(self._narrow):
            return nothing, no_hits
        met_rays, met = [nothing], [no_hits]
        for near, faces in self._narrow_pairs(origins, directions):
            found = self._nearest_of(faces[:, None], origins[near], directions[near])
            met_rays.append(near[found.hit])
            met.append(_take(found, found.hit))
        rays, hits = np.concatenate(met_rays), _join(met)
        order = np.lexsort((hits.face, hits.distance, rays))
        _, first = np.unique(rays[order], return_index=True)
        return rays[order[first]], _take(hits, order[first])

    def _narrow_pairs(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Give rays and the narrow faces that they come near to, some pairs at a time."""
        rays = _as_float32(origins, directions)
        counts = self._around_narrow.count_intersections(self._tensor(rays)).numpy()
        near = np.flatnonzero(counts)
        ends = np.cumsum(counts[near], dtype=np.int64) // _PAIRS
        for part in np.split(near, np.flatnonzero(np.diff(ends)) + 1):
            if not len(part):
                continue
            found = self._around_narrow.list_intersections(self._tensor(rays[part]))
            boxes = found["primitive_ids"].numpy().astype(np.int64) // _BOX_FACES
            pairs = np.unique(found["ray_ids"].numpy().astype(np.int64) * len(self._narrow) + boxes)
            yield part[pairs // len(self._narrow)], self._narrow[pairs % len(self._narrow)]

    def _nearest_of(
        self,
        candidates: NDArray[np.int64],
        origins: NDArray[np.float64],
        directions: NDArray[np.float64],
    ) -> Hits:
        """Meet each of m rays with its own candidates, shape (m, c), in float64."""
        corners = self._corners[candidates] - origins[:, None, None, :]
        # Two faces at an edge have exactly opposite numbers for it, so no ray slips between;
        # at a vertex rounding alone decides, and every face that it may have cut off counts.
        sides = np.cross(corners, np.roll(corners, -1, axis=2))
        sides = np.einsum("mckd,md->mck", sides, directions)
        farthest = np.einsum("mckd,mckd->mck", corners, corners).max(axis=2, keepdims=True)
        slack = _ROUNDING * farthest * np.linalg.norm(directions, axis=1)[:, None, None]
        planes = self._planes[candidates]
        above = planes[:, :, 3] - np.einsum("mcd,md->mc", planes[:, :, :3], origins)
        along = np.einsum("mcd,md->mc", planes[:, :, :3], directions)
        inside = (sides >= -slack).all(axis=2) | (sides <= slack).all(axis=2)
        inside &= (candidates != MISS) & (along != 0)
        distances = np.divide(above, along, out=np.full(above.shape, np.inf), where=inside)
        distances[distances < 0] = np.inf

        # Equal distances go to the lower face, so that the answer depends on the ray alone.
        nearest = np.lexsort((candidates, distances), axis=1)[:, :1]
        distance = np.take_along_axis(distances, nearest, axis=1)[:, 0]
        face = np.take_along_axis(candidates, nearest, axis=1)[:, 0]
        weights = np.take_along_axis(sides, nearest[:, :, None], axis=1)[:, 0]
        found = np.isfinite(distance)
        weights = np.divide(
            weights, weights.sum(axis=1, keepdims=True), out=weights, where=found[:, None]
        )
        return Hits(
            distance,
            np.where(found, face, MISS),
            np.where(found[:, None], weights[:, [2, 0]], 0.0),
        )

    def _faces_around(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        least = np.eye(3)[np.argmin(np.abs(directions), axis=1)]
        first = _unit(np.cross(directions, least))
        second = _unit(np.cross(directions, first))
        spread = _BUNDLE_RADIUS * (
            _BUNDLE[:, 0, None] * first[:, None, :] + _BUNDLE[:, 1, None] * second[:, None, :]
        )
        around = (origins[:, None, :] + spread).reshape(-1, 3)
        hits, _ = self._cast(around, np.repeat(directions, len(_BUNDLE), axis=0))
        return hits.face.reshape(-1, len(_BUNDLE))


def _as_float32(
    origins: NDArray[np.float64], directions: NDArray[np.float64]
) -> NDArray[np.float32]:
    rays = np.empty((len(origins), 6), dtype=np.float32)
    # Column by column, for inner loops of three are slow.
    for axis in range(3):
        rays[:, axis] = origins[:, axis]
        rays[:, 3 + axis] = directions[:, axis]
    return rays


def _face_planes(surface: Surface) -> NDArray[np.float64]:
    """Give normal (not unit), offset, and the edge band of each face, shape (f, 5).

    The distance from a point to a face's nearest edge is at least its least
    barycentric weight × twice the area / the longest edge; `RayCaster` compares that with
    `LATERAL_ERROR` without dividing.
    """
    corners, crosses = surface.triangles, surface.face_crosses
    edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    offsets = _dot(crosses, corners[:, 0])
    return np.column_stack([crosses, offsets, LATERAL_ERROR * edges.max(axis=1)])


def _boxes_around(
    triangles: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Give vertices and faces of a closed box along the longest edge of each narrow triangle."""
    import trimesh

    edges = np.roll(triangles, -1, axis=1) - triangles
    rows = np.arange(len(triangles))
    longest = np.linalg.norm(edges, axis=2).argmax(axis=1)
    edge = edges[rows, longest]
    along = _unit(edge)
    aside = _unit(np.cross(along, np.eye(3)[np.argmin(np.abs(along), axis=1)]))
    axes = np.stack(
        [edge + 2 * _ROOM * along, 2 * _ROOM * aside, 2 * _ROOM * np.cross(along, aside)], axis=1
    )
    box = trimesh.creation.box()
    centres = triangles[rows, longest] + 0.5 * edge
    vertices = centres[:, None] + box.vertices @ axes
    faces = box.faces + len(box.vertices) * rows[:, None, None]
    return vertices.reshape(-1, 3), faces.reshape(-1, 3)


def _put(hits: Hits, rays: NDArray[np.intp], others: Hits) -> None:
    hits.distance[rays] = others.distance
    hits.face[rays] = others.face
    hits.barycentric[rays] = others.barycentric


def _join(parts: list[Hits]) -> Hits:
    return Hits(
        np.concatenate([part.distance for part in parts]),
        np.concatenate([part.face for part in parts]),
        np.concatenate([part.barycentric for part in parts]),
    )


def _take(hits: Hits, rays: NDArray[np.intp] | NDArray[np.bool_]) -> Hits:
    return Hits(hits.distance[rays], hits.face[rays], hits.barycentric[rays])


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    # A ray without direction goes nowhere; dividing by zero would make it NaN.
    return vectors / np.where(lengths > 0, lengths, 1.0)


def _dot(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Dot products of rows of three; written out, for BLAS may order sums by the batch."""
    return first[:, 0] * second[:, 0] + first[:, 1] * second[:, 1] + first[:, 2] * second[:, 2]
