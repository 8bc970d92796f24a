"""Random numbers of sensors and touches, independent between effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.seeds import spawn_generator


@dataclass(frozen=True)
class RandomFields:
    """Source of the random numbers of n touches with a sensor.

    Random numbers depend only on the seed, the effect, and the key of the sensor or touch.

    Attributes
    ----------
    seed : int
        Seed of the run.
    touches : sequence of tuple
        The key of each touch, such as ``("cup", "mug", 3, "fixation", 0)``.
    sensor : str
        The key of the sensor. Touches with the same sensor have the same gains and dead cells.
    """

    seed: int
    touches: Sequence[tuple[object, ...]]
    sensor: str = "sensor"

    def select(self, rows: NDArray[np.intp]) -> RandomFields:
        """Return the source for the touches at `rows`."""
        return RandomFields(self.seed, [self.touches[row] for row in rows], self.sensor)

    def of_sensor(self, effect: str) -> np.random.Generator:
        """Return the generator of an effect's random numbers that are constant for the sensor."""
        return spawn_generator(self.seed, "sensor", self.sensor, effect)

    def of_touches(self, effect: str, shape: tuple[int, ...]) -> FloatArray:
        """Draw standard normal deviates (n, *shape) of an effect that differ between touches."""
        fields = [
            spawn_generator(self.seed, "touch", *names, effect).standard_normal(shape)
            for names in self.touches
        ]
        return np.reshape(fields, (len(fields), *shape))
