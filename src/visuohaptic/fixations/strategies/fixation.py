"""Strategy `fixation`: the fixations of the attention model, in order."""

from __future__ import annotations

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.attended_views import AttendedView


def choose(view: AttendedView, attention: AttentionParameters, *_: object) -> Scanpath:
    """Choose fixations on the saliency map, including the spares that `view.attended.scanpath` lacks."""
    return view.scan(view.attended.saliency, attention)
