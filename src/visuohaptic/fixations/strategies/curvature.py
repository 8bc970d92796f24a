"""The most curved places of a view."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.attended_views import AttendedView

SMALLEST_PEAK = 1e-30
"""A view of flat faces alone has no curvature; its map stays zero."""


def choose(one: AttendedView, attention: AttentionParameters, *_: object) -> Scanpath:
    """Let the eye follow curvature alone, with the same inhibition of return."""
    curvature = one.seen.curvature[one.place]
    peak = max(float(curvature.max()), SMALLEST_PEAK)
    return one.scan(curvature / np.float32(peak), attention)
