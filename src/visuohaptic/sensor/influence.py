"""How far each effect moves the tactile images."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.touching import touch


def image_shifts(
    caster: RayCaster,
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    parameters: SensorParameters,
    scene: Scene,
    fields: RandomFields | None = None,
) -> dict[str, float]:
    """Leave out one effect at a time and measure how far the images change.

    Parameters
    ----------
    caster, points, normals, parameters, scene, fields
        As for `touch`.

    Returns
    -------
    dict of str to float
        For each tactile effect that ran: mean absolute difference of a sensing point's
        value between the scene and the scene without the effect, 0 to 1. Random
        numbers stay the same, so nothing else moves.
    """
    whole = touch(caster, points, normals, parameters, scene, fields)
    shifts = {}
    for record in whole.effects:
        if not record.runs:
            continue
        modes = scene.effects.model_copy(update={record.effect: "never"})
        without = scene.model_copy(update={"effects": modes})
        part = touch(caster, points, normals, parameters, without, fields)
        shifts[record.effect] = float(np.abs(part.images - whole.images).mean())
    return shifts
