"""Targets of rays at vertices, edges and faces, and distances of hits from the plane of their face."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.geometry.raycasting import Hits
from visuohaptic.geometry.surface import Surface

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def everything(distances: FloatArray) -> BoolArray:
    """Return True for every ray: the ray caster then recomputes all rays in float64."""
    return np.ones(len(distances), dtype=bool)


def plane_errors(
    surface: Surface, origins: FloatArray, directions: FloatArray, hits: Hits
) -> FloatArray:
    """Compute the distance (n,) of each hit from the plane of its face, along the normal; 0 for a miss.

    `origins` and `directions` have the shape (n, 3); distances have the unit of the surface.
    """
    errors, met = np.zeros(len(origins)), hits.hit
    faces = hits.face[met]
    points = origins[met] + hits.distance[met, None] * directions[met]
    offsets = points - surface.triangles[faces, 0]
    errors[met] = np.abs((offsets * surface.face_normals[faces]).sum(axis=1))
    return errors


def aim(surface: Surface, generator: np.random.Generator, count: int) -> FloatArray:
    """Sample `count` points (count, 3): a third at vertices, a third on edges, a third at centres of faces."""
    corners = surface.triangles[generator.integers(0, len(surface.faces), count)]
    share = np.rint(generator.random((count, 1)) * 64) / 64
    share[::3] = 0
    targets = corners[:, 0] * (1 - share) + corners[:, 1] * share
    targets[2::3] = corners[2::3].mean(axis=1)
    return targets
