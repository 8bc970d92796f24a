"""Cast rays in float32 by Embree through embreex, which finds only first hits; NumPy computes the rest."""

from __future__ import annotations

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.cast_rays import Crossings, FirstFaces, Rays
from visuohaptic.geometry.nearest import nearest_on
from visuohaptic.geometry.overlaps import blocks_by_count
from visuohaptic.geometry.vectors import dot

# Pairs of a ray or point and a face that are compared at once; limits the memory.
_PAIRS = 1 << 18


class EmbreexScene:
    """Triangles in a scene of Embree; see `cast_rays.RayScene`."""

    def __init__(self, corners: FloatArray, faces: IntArray) -> None:
        self._triangles = corners[faces]
        self._scene = EmbreeScene(robust=True)
        # The scene reads these arrays as long as it exists.
        self._mesh = TriangleMesh(
            self._scene,
            np.ascontiguousarray(corners, dtype=np.float32),
            np.ascontiguousarray(faces, dtype=np.int32),
        )

    def first_faces(self, rays: Rays) -> FirstFaces:
        """Return the first face that each ray hits, and the position on the face."""
        origins, directions = (np.ascontiguousarray(half) for half in np.hsplit(rays, 2))
        answer = self._scene.run(origins, directions, output=True)
        return answer["primID"].astype(np.int64), answer["u"], answer["v"]

    def crossings(self, rays: Rays) -> Crossings:
        """Return all hits of rays; rays with a first hit are compared with all faces."""
        hitting = np.flatnonzero(self.first_faces(rays)[0] >= 0)
        hits = [(hitting[:0], hitting[:0])]
        for block in blocks_by_count(hitting, np.full(len(hitting), len(self._triangles)), _PAIRS):
            rows, faces = np.nonzero(_meets(self._triangles, rays[block].astype(np.float64)))
            hits.append((block[rows], faces))
        ray_indices, face_indices = zip(*hits, strict=True)
        return np.concatenate(ray_indices), np.concatenate(face_indices)

    def count_crossings(self, rays: Rays) -> IntArray:
        """Count the faces that each ray hits."""
        return np.bincount(self.crossings(rays)[0], minlength=len(rays))

    def nearest_faces(self, points: FloatArray) -> IntArray:
        """Return the face nearest to each point, compared with all faces."""
        nearest = [np.zeros(0, np.int64)]
        for block in blocks_by_count(
            np.arange(len(points)), np.full(len(points), len(self._triangles)), _PAIRS
        ):
            pairs = (len(block), len(self._triangles), 3)
            repeated = np.broadcast_to(points[block, None], pairs).reshape(-1, 3)
            offsets = nearest_on(np.tile(self._triangles, (len(block), 1, 1)), repeated) - repeated
            nearest.append(dot(offsets, offsets).reshape(pairs[:2]).argmin(axis=1))
        return np.concatenate(nearest)


def _meets(triangles: FloatArray, rays: FloatArray) -> BoolArray:
    """Return whether each of n rays hits each of f triangles, (n, f), bool; rays in the plane of a triangle do not."""
    origins, directions = np.split(rays[:, None], 2, axis=-1)
    edges = np.roll(triangles, -1, axis=1) - triangles
    # The sign of direction · (corner - origin) × edge is the side on which a ray passes the edge.
    moments = np.cross(triangles, edges)
    turned = np.cross(origins, directions)
    sides = [
        dot(directions, moments[None, :, edge]) + dot(turned, edges[None, :, edge])
        for edge in range(3)
    ]
    crosses = np.cross(edges[:, 0], edges[:, 1])[None]
    along = dot(crosses, directions)
    ahead = (dot(crosses, triangles[None, :, 0]) - dot(crosses, origins)) * along >= 0
    inside = np.all([side >= 0 for side in sides], axis=0)
    inside |= np.all([side <= 0 for side in sides], axis=0)
    return inside & ahead & (along != 0)
