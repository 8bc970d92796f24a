"""Embree's answers in float32 through embreex, which gives the first face of a ray alone; NumPy gives the rest."""

from __future__ import annotations

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.geometry.cast_rays import Crossings, FirstFaces, Rays
from visuohaptic.geometry.nearest import nearest_on
from visuohaptic.geometry.overlaps import in_parts
from visuohaptic.geometry.vectors import dot

# Pairs of a ray or a point and a face that are compared at once, for the memory that they take.
_PAIRS = 1 << 18


class EmbreexScene:
    """Triangles in a scene of Embree; see `cast_rays.Scene`."""

    def __init__(self, corners: FloatArray, faces: IntArray) -> None:
        self._triangles = corners[faces]
        self._scene = EmbreeScene(robust=True)
        # The scene reads these as long as it lives.
        self._mesh = TriangleMesh(
            self._scene,
            np.ascontiguousarray(corners, dtype=np.float32),
            np.ascontiguousarray(faces, dtype=np.int32),
        )

    def first_faces(self, rays: Rays) -> FirstFaces:
        """Give the face that each ray meets first, and where on it."""
        origins, directions = (np.ascontiguousarray(part) for part in np.hsplit(rays, 2))
        answer = self._scene.run(origins, directions, output=True)
        return answer["primID"].astype(np.int64), answer["u"], answer["v"]

    def crossings(self, rays: Rays) -> Crossings:
        """Give every face that each ray meets; all faces are tried for a ray that meets one."""
        met = np.flatnonzero(self.first_faces(rays)[0] >= 0)
        found = [(met[:0], met[:0])]
        for part in in_parts(met, np.full(len(met), len(self._triangles)), _PAIRS):
            which, faces = np.nonzero(_meets(self._triangles, rays[part].astype(np.float64)))
            found.append((part[which], faces))
        rays_met, faces_met = zip(*found, strict=True)
        return np.concatenate(rays_met), np.concatenate(faces_met)

    def count_crossings(self, rays: Rays) -> IntArray:
        """Count the faces that each ray meets."""
        return np.bincount(self.crossings(rays)[0], minlength=len(rays))

    def nearest_faces(self, points: FloatArray) -> IntArray:
        """Give the face nearest to each point; all faces are tried."""
        nearest = [np.zeros(0, np.int64)]
        for part in in_parts(
            np.arange(len(points)), np.full(len(points), len(self._triangles)), _PAIRS
        ):
            pairs = (len(part), len(self._triangles), 3)
            asked = np.broadcast_to(points[part, None], pairs).reshape(-1, 3)
            apart = nearest_on(np.tile(self._triangles, (len(part), 1, 1)), asked) - asked
            nearest.append(dot(apart, apart).reshape(pairs[:2]).argmin(axis=1))
        return np.concatenate(nearest)


def _meets(triangles: FloatArray, rays: FloatArray) -> BoolArray:
    """Whether each of n rays meets each of f triangles, shape (n, f), bool; in its plane it does not."""
    origins, directions = np.split(rays[:, None], 2, axis=-1)
    edges = np.roll(triangles, -1, axis=1) - triangles
    # The side of an edge on which a ray passes: direction · (corner - origin) × edge.
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
