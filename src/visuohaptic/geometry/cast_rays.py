"""What a scene answers, whichever package casts its rays: triangles, in float32."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray

Rays = NDArray[np.float32]
FirstFaces = tuple[IntArray, NDArray[np.float32], NDArray[np.float32]]
Crossings = tuple[IntArray, IntArray]


class Scene(Protocol):
    """Triangles that rays are cast at, in float32. It is made of corners, shape (v, 3), and faces, shape (f, 3)."""

    def first_faces(self, rays: Rays) -> FirstFaces:
        """Give the face that each ray (n, 6), origin and direction, meets first, and where on it.

        The face is int64, -1 for a miss; then come the weights, float32, of its second and third
        corner.
        """
        ...

    def crossings(self, rays: Rays) -> Crossings:
        """Give every face that rays, shape (n, 6), meet: a ray and a face for each, in any order."""
        ...

    def count_crossings(self, rays: Rays) -> IntArray:
        """Count the faces that rays, shape (n, 6), meet: shape (n,)."""
        ...

    def nearest_faces(self, points: FloatArray) -> IntArray:
        """Give the faces, shape (n,), nearest to points, shape (n, 3)."""
        ...
