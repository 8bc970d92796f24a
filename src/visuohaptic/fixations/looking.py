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
    """One viewpoint of an object, `class/name`, without a look."""

    key: str
    viewpoint: int
    caster: RayCaster
    camera: Camera


@dataclass(frozen=True)
class Look(Standpoint):
    """One viewpoint with its view, at `place` among those that were `seen` together, and attention in it."""

    seen: Views
    place: int
    attended: Attention

    def scan(self, saliency: NDArray[np.float32], attention: AttentionParameters) -> Scanpath:
        """Let the eye scan the view by a map of its pixels."""
        seen, place = self.seen, self.place
        surface = (seen.mask[place], seen.point[place], seen.normal[place], seen.face[place])
        return scan(saliency, *surface, attention)


def attend_to(
    seen: Views,
    caster: RayCaster,
    key: str,
    cameras: Mapping[int, Camera],
    attention: AttentionParameters,
) -> list[Look]:
    """Find saliency and fixations in the views from some viewpoints, by their numbers; each is alone."""
    eyes = np.stack([camera.eye for camera in cameras.values()]) if cameras else None
    attentions = attend(**seen.arrays(), parameters=attention, eye=eyes)
    return [
        Look(key, number, caster, camera, seen, place, attentions[place])
        for place, (number, camera) in enumerate(cameras.items())
    ]
