"""What casts rays in float32: Embree through Open3D or embreex; `raycasting.RayCaster` settles what that leaves open.

What float32 may take wrongly is found again in float64, so nearly always the same bits come out of both;
docs/decisions.md says how often not.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MissingPackageError
from visuohaptic.functions import Function
from visuohaptic.geometry.arrays import Floats, Integers

Rays = NDArray[np.float32]
FirstFaces = tuple[Integers, NDArray[np.float32], NDArray[np.float32]]
Crossings = tuple[Integers, Integers]


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

    def count_crossings(self, rays: Rays) -> Integers:
        """Count the faces that rays, shape (n, 6), meet: shape (n,)."""
        ...

    def nearest_faces(self, points: Floats) -> Integers:
        """Give the faces, shape (n,), nearest to points, shape (n, 3)."""
        ...


SCENES: Mapping[str, Function] = {
    "open3d": Function("visuohaptic.geometry.open3d_scene:Open3DScene"),
    "embreex": Function("visuohaptic.geometry.embreex_scene:EmbreexScene"),
}
"""Packages that cast rays; the first that is installed does, unless another one is asked for."""


def installed_package() -> str:
    """Name the package that casts rays; raises `MissingPackageError` if there is none."""
    for package in SCENES:
        if find_spec(package) is not None:
            return package
    raise MissingPackageError(
        "Neither open3d nor embreex is installed, and one of them must cast the rays; "
        "`pip install embreex` or `pip install 'visuohaptic[open3d]'` brings one."
    )
