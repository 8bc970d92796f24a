"""Random numbers of a sensor or a touch, independent of the other effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.seeds import spawn_generator


@dataclass(frozen=True)
class RandomFields:
    """Source of the random numbers of a sensor array.

    Each field depends only on the seed, the effect, and the key of the sensor or touch. `touches` holds
    one chain of names a touch, such as ``("cup/mug", 3, "fixation", 0)``; `sensor` names the sensor,
    whose gains and dead cells stay from touch to touch.
    """

    seed: int
    touches: Sequence[tuple[object, ...]]
    sensor: str = "sensor"

    def select(self, rows: NDArray[np.intp]) -> RandomFields:
        """Give the fields of some touches alone."""
        return RandomFields(self.seed, [self.touches[row] for row in rows], self.sensor)

    def of_sensor(self, effect: str) -> np.random.Generator:
        """Give the random generator of an effect's values that belong to the sensor."""
        return spawn_generator(self.seed, "sensor", self.sensor, effect)

    def of_touches(self, effect: str, resolution: int) -> FloatArray:
        """Draw each touch's standard normal deviates for an effect, shape (n, r, r)."""
        shape = (resolution, resolution)
        fields = [
            spawn_generator(self.seed, "touch", *names, effect).standard_normal(shape)
            for names in self.touches
        ]
        return np.reshape(fields, (len(fields), *shape))
