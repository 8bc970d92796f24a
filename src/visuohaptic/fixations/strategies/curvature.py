"""Strategy `curvature`: the most curved parts of a view."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.attended_views import AttendedView

SMALLEST_PEAK = 1e-30
"""Least divisor, so that the map of a view without curvature stays zero."""


def choose(view: AttendedView, attention: AttentionParameters, *_: object) -> Scanpath:
    """Choose fixations on the map of curvature in place of the saliency map."""
    curvature = view.views.curvature[view.index]
    peak = max(float(curvature.max()), SMALLEST_PEAK)
    return view.scan(curvature / np.float32(peak), attention)
