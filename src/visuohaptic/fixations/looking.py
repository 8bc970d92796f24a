"""Views of an object, and attention in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.attention.model import Attention, attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath, scan
from visuohaptic.fixations.rendering import Views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster


@dataclass(frozen=True)
class Standpoint:
    """One viewpoint of an object, without a look.

    Attributes
    ----------
    key : str
        `class/name` of the object.
    viewpoint : int
        Number of the viewpoint.
    caster : RayCaster
        The object.
    camera : Camera
        The viewpoint.
    """

    key: str
    viewpoint: int
    caster: RayCaster
    camera: Camera


@dataclass(frozen=True)
class Look(Standpoint):
    """One viewpoint of an object, with saliency and fixations.

    Attributes
    ----------
    seen : Views
        The views of all viewpoints that were looked from together.
    place : int
        Which of these views is this one's.
    attended : Attention
        Saliency and fixations of the view.
    """

    seen: Views
    place: int
    attended: Attention

    def scan(self, saliency: NDArray[np.float32], attention: AttentionParameters) -> Scanpath:
        """Let the eye scan the view by a map of its pixels."""
        seen, place = self.seen, self.place
        return scan(
            saliency,
            seen.mask[place],
            seen.point[place],
            seen.normal[place],
            seen.face[place],
            attention,
        )


def attend_to(
    seen: Views,
    caster: RayCaster,
    key: str,
    cameras: Mapping[int, Camera],
    attention: AttentionParameters,
) -> list[Look]:
    """Find saliency and fixations in rendered views of an object: a `Look` a viewpoint.

    `cameras` are the views' viewpoints by their numbers; none changes what another gives.
    """
    attentions = attend(
        colour=seen.colour,
        mask=seen.mask,
        point=seen.point,
        normal=seen.normal,
        face=seen.face,
        curvature=seen.curvature,
        parameters=attention,
        eye=np.stack([camera.eye for camera in cameras.values()]) if cameras else None,
    )
    return [
        Look(key, number, caster, camera, seen, place, attentions[place])
        for place, (number, camera) in enumerate(cameras.items())
    ]
