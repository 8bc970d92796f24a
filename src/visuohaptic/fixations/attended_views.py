"""Viewpoints of an object, with and without a view and attention."""

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
    """A viewpoint of an object, without a view.

    Attributes
    ----------
    key : str
        The object, ``class/name``.
    number : int
        The number of the viewpoint.
    caster : RayCaster
        The object's surface, prepared for rays.
    camera : Camera
    """

    key: str
    number: int
    caster: RayCaster
    camera: Camera


@dataclass(frozen=True)
class AttendedView(Viewpoint):
    """A viewpoint with its view and attention.

    Attributes
    ----------
    views : Views
        Views of the object that were rendered together.
    index : int
        The index of this viewpoint in `views`.
    attended : Attention
        Saliency and fixations of this view.
    """

    views: Views
    index: int
    attended: Attention

    def scan(self, saliency: NDArray[np.float32], attention: AttentionParameters) -> Scanpath:
        """Choose fixations on a map (h, w), 0 to 1, of the view's pixels, as `attention.scan` does."""
        views, index = self.views, self.index
        surface = (views.mask[index], views.point[index], views.normal[index], views.face[index])
        return scan(saliency, *surface, attention)
