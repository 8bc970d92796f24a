"""The interface of scenes: triangles that rays are cast at in float32, by Open3D or embreex."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray

Rays = NDArray[np.float32]
FirstFaces = tuple[IntArray, NDArray[np.float32], NDArray[np.float32]]
Crossings = tuple[IntArray, IntArray]


class RayScene(Protocol):
    """Triangles that rays are cast at, in float32; constructed from vertices (v, 3) and faces (f, 3)."""

    def first_faces(self, rays: Rays) -> FirstFaces:
        """Return the first face that each ray hits, and the position on the face.

        Parameters
        ----------
        rays : ndarray of shape (n, 6), float32
            Origin and direction of each ray.

        Returns
        -------
        faces : ndarray of shape (n,), int64
            Index of the face; -1 for a miss.
        second, third : ndarray of shape (n,), float32
            Barycentric weights of the second and third corner.
        """
        ...

    def crossings(self, rays: Rays) -> Crossings:
        """Return all hits of rays (n, 6) as ray indices (h,) and face indices (h,), in any order."""
        ...

    def count_crossings(self, rays: Rays) -> IntArray:
        """Count the faces that each ray hits: (n, 6) to (n,)."""
        ...

    def nearest_faces(self, points: FloatArray) -> IntArray:
        """Return the index of the face nearest to each point: (n, 3) to (n,)."""
        ...
