"""The eye's fixations, in their order."""

from __future__ import annotations

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.attended_views import AttendedView


def choose(one: AttendedView, attention: AttentionParameters, *_: object) -> Scanpath:
    """Let the eye go on from where the look ended."""
    return one.scan(one.attended.saliency, attention)
