"""Cast rays in float32 by Embree through Open3D."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.geometry.cast_rays import Crossings, FirstFaces, Rays
from visuohaptic.geometry.compiled_open3d import open3d


class Open3DScene:
    """Triangles in a scene of Open3D; see `cast_rays.RayScene`."""

    def __init__(self, corners: FloatArray, faces: IntArray) -> None:
        self._tensor = open3d.core.Tensor
        self._miss = open3d.t.geometry.RaycastingScene.INVALID_ID
        self._scene = open3d.t.geometry.RaycastingScene(nthreads=1)
        self._scene.add_triangles(
            self._tensor(np.ascontiguousarray(corners, dtype=np.float32)),
            self._tensor(np.ascontiguousarray(faces, dtype=np.uint32)),
        )

    def first_faces(self, rays: Rays) -> FirstFaces:
        """Return the first face that each ray hits, and the position on the face."""
        answer = self._scene.cast_rays(self._tensor(rays))
        faces = answer["primitive_ids"].numpy()
        missed = faces == self._miss
        faces = faces.astype(np.int64)
        faces[missed] = -1
        second, third = answer["primitive_uvs"].numpy().T
        return faces, second, third

    def crossings(self, rays: Rays) -> Crossings:
        """Return all hits of rays, as ray indices and face indices."""
        if not len(rays):  # Open3D ends the process if there are no rays
            return np.zeros(0, np.int64), np.zeros(0, np.int64)
        answer = self._scene.list_intersections(self._tensor(rays))
        rays_hit, faces_hit = (
            answer[name].numpy().astype(np.int64) for name in ("ray_ids", "primitive_ids")
        )
        return rays_hit, faces_hit

    def count_crossings(self, rays: Rays) -> IntArray:
        """Count the faces that each ray hits."""
        counts: IntArray = self._scene.count_intersections(self._tensor(rays)).numpy()
        return counts

    def nearest_faces(self, points: FloatArray) -> IntArray:
        """Return the face nearest to each point."""
        answer = self._scene.compute_closest_points(self._tensor(points.astype(np.float32)))
        faces: IntArray = answer["primitive_ids"].numpy().astype(np.int64)
        return faces
