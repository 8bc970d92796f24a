"""Shapes for the sensor's tests, beside those of the library's own gallery."""

import numpy as np

from visuohaptic.sensor.gallery import build_surface as surface_of
from visuohaptic.sensor.gallery import hard_probes as all_hard_probes
from visuohaptic.sensor.gallery import join as joined
from visuohaptic.sensor.gallery import sheet

__all__ = ["box", "hard_probes", "joined", "sheet", "surface_of"]


def hard_probes():
    return {probe.name: probe for probe in all_hard_probes()}


def box(lower, upper):
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    faces = [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]  # fmt: skip
    return surface_of(lower + corners * np.subtract(upper, lower), faces)
