"""Random numbers that belong to a sensor or to a touch, whatever else is switched on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.seeds import spawn_generator


@dataclass(frozen=True)
class RandomFields:
    """Where an array's random numbers come from.

    Every field hangs on the seed, the effect that asks and the sensor or touch it is for: on nothing
    else, so that effects, batches and the order of touches don't move one another's numbers.

    Attributes
    ----------
    seed : int
        The experiment's seed.
    touches : sequence of tuple
        One chain of names a touch, such as ``("cup/mug", 3, "fixation", 0)``.
    sensor : str
        Name of the sensor, whose gains and dead cells stay from touch to touch.
    """

    seed: int
    touches: Sequence[tuple[object, ...]]
    sensor: str = "sensor"

    def select(self, rows: NDArray[np.intp]) -> RandomFields:
        """Give the fields of some touches alone."""
        return RandomFields(self.seed, [self.touches[row] for row in rows], self.sensor)

    def of_sensor(self, effect: str) -> np.random.Generator:
        """Give the generator of what is the sensor's own in an effect."""
        return spawn_generator(self.seed, "sensor", self.sensor, effect)

    def of_touches(self, effect: str, resolution: int) -> NDArray[np.float64]:
        """Draw each touch's standard normal deviates for an effect, shape (n, r, r)."""
        shape = (resolution, resolution)
        fields = [
            spawn_generator(self.seed, "touch", *names, effect).standard_normal(shape)
            for names in self.touches
        ]
        return np.reshape(fields, (len(fields), *shape))
