"""Viewpoints of an object, with attention or without."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.attention.model import Attention
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath, scan
from visuohaptic.fixations.rendering import Views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster


@dataclass(frozen=True)
class Viewpoint:
    """One viewpoint of an object, `class/name`, without a look."""

    key: str
    viewpoint: int
    caster: RayCaster
    camera: Camera


@dataclass(frozen=True)
class AttendedView(Viewpoint):
    """One viewpoint with its view, at `place` among those that were `seen` together, and attention in it."""

    seen: Views
    place: int
    attended: Attention

    def scan(self, saliency: NDArray[np.float32], attention: AttentionParameters) -> Scanpath:
        """Let the eye scan the view by a map of its pixels."""
        seen, place = self.seen, self.place
        surface = (seen.mask[place], seen.point[place], seen.normal[place], seen.face[place])
        return scan(saliency, *surface, attention)
