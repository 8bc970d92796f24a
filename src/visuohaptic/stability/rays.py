"""Rays at an object's vertices, edges and faces, and how far from a face a hit lies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.geometry.raycasting import Hits
from visuohaptic.geometry.surface import Surface

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def everything(distances: FloatArray) -> BoolArray:
    """Name every ray as one to be settled."""
    return np.ones(len(distances), dtype=bool)


def plane_errors(
    surface: Surface, origins: FloatArray, directions: FloatArray, hits: Hits
) -> FloatArray:
    """Measure how far each hit lies from the plane of its face, along the normal; 0 for a miss."""
    errors, met = np.zeros(len(origins)), hits.hit
    faces = hits.face[met]
    points = origins[met] + hits.distance[met, None] * directions[met]
    offsets = points - surface.triangles[faces, 0]
    errors[met] = np.abs((offsets * surface.face_normals[faces]).sum(axis=1))
    return errors


def aim(surface: Surface, generator: np.random.Generator, count: int) -> FloatArray:
    """Give points at vertices, at edges and within faces, a third each."""
    corners = surface.triangles[generator.integers(0, len(surface.faces), count)]
    share = np.rint(generator.random((count, 1)) * 64) / 64
    share[::3] = 0
    targets = corners[:, 0] * (1 - share) + corners[:, 1] * share
    targets[2::3] = corners[2::3].mean(axis=1)
    return targets
