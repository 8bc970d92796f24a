"""Embree's answers in float32 through Open3D."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.geometry.cast_rays import Crossings, FirstFaces, Rays
from visuohaptic.geometry.compiled_open3d import open3d


class Open3DScene:
    """Triangles in a scene of Open3D; see `cast_rays.Scene`."""

    def __init__(self, corners: FloatArray, faces: IntArray) -> None:
        self._tensor = open3d.core.Tensor
        self._miss = open3d.t.geometry.RaycastingScene.INVALID_ID
        self._scene = open3d.t.geometry.RaycastingScene(nthreads=1)
        self._scene.add_triangles(
            self._tensor(np.ascontiguousarray(corners, dtype=np.float32)),
            self._tensor(np.ascontiguousarray(faces, dtype=np.uint32)),
        )

    def first_faces(self, rays: Rays) -> FirstFaces:
        """Give the face that each ray meets first, and where on it."""
        answer = self._scene.cast_rays(self._tensor(rays))
        faces = answer["primitive_ids"].numpy()
        missed = faces == self._miss
        faces = faces.astype(np.int64)
        faces[missed] = -1
        second, third = answer["primitive_uvs"].numpy().T
        return faces, second, third

    def crossings(self, rays: Rays) -> Crossings:
        """Give every face that each ray meets."""
        if not len(rays):  # Open3D would end the process
            return np.zeros(0, np.int64), np.zeros(0, np.int64)
        found = self._scene.list_intersections(self._tensor(rays))
        ray, face = (found[name].numpy().astype(np.int64) for name in ("ray_ids", "primitive_ids"))
        return ray, face

    def count_crossings(self, rays: Rays) -> IntArray:
        """Count the faces that each ray meets."""
        counts: IntArray = self._scene.count_intersections(self._tensor(rays)).numpy()
        return counts

    def nearest_faces(self, points: FloatArray) -> IntArray:
        """Give the face nearest to each point."""
        answer = self._scene.compute_closest_points(self._tensor(points.astype(np.float32)))
        faces: IntArray = answer["primitive_ids"].numpy().astype(np.int64)
        return faces
