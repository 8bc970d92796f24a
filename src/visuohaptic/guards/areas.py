"""A guard of the baseline: random places are uniform by area."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from visuohaptic.geometry.surface import Surface
from visuohaptic.guards.verdicts import ALARM, Verdict, judge, uniform_p_value

Floats = NDArray[np.float64]

UNIFORM = "random places are uniform by area"
BINS = 16
LEAST = 20 * BINS
"""Places, so that the chi-squared distribution holds far out."""

SLIVER = 1e-6
"""Share of its longest side that a face must be high for a point to have weights in it."""


def coordinates(surface: Surface, points: Floats, faces: NDArray[np.int64]) -> Floats:
    """Give three numbers of each point that are uniform in [0, 1] if points are uniform by area.

    Of points (n, 3) on faces (n,) of the surface it gives (m, 3), as points on slivers are left out:
    the share of area of all smaller faces and of the part of its own that is nearer to the first
    corner; that part's share of its face; and how far along the opposite edge it lies.
    """
    triangles = surface.triangles[faces]
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(first, second)
    double = np.einsum("nd,nd->n", normal, normal)
    offset = points - triangles[:, 0]
    longest = np.maximum(np.einsum("nd,nd->n", first, first), np.einsum("nd,nd->n", second, second))
    usable = np.sqrt(double) > SLIVER * longest
    safe = np.where(usable, double, 1)
    along_first = np.einsum("nd,nd->n", np.cross(offset, second), normal) / safe
    along_second = np.einsum("nd,nd->n", np.cross(first, offset), normal) / safe
    away = along_first + along_second
    usable &= away > 0
    nearer = np.clip(away, 0, 1) ** 2
    # Small faces first: to draw faces alike, whatever their size, then shows.
    order = np.argsort(surface.face_areas, kind="stable")
    before = np.empty(len(order))
    before[order] = np.cumsum(surface.face_areas[order]) - surface.face_areas[order]
    share = (before[faces] + nearer * surface.face_areas[faces]) / surface.face_areas.sum()
    along = along_second / np.where(usable, away, 1)
    return np.clip(np.column_stack([share, nearer, along])[usable], 0, 1)


def guard_areas(drawn: Sequence[Floats]) -> Verdict:
    """Test by chi-squared that each object's `coordinates`, those passed over among them, are uniform by area."""
    values = np.concatenate([np.empty((0, 3)), *drawn])
    if len(values) < LEAST:
        found = f"There are {len(values)} random places, and {LEAST} are needed."
        return Verdict(UNIFORM, "not tested", found)
    p_values = [uniform_p_value(column, BINS) for column in values.T]
    return judge(
        UNIFORM,
        held=min(p_values) > ALARM,
        found=f"{len(values)} places have p values of {p_values[0]:.2g} over faces, and of "
        f"{p_values[1]:.2g} and {p_values[2]:.2g} within them.",
    )
