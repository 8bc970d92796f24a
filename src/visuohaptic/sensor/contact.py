"""What a touch came to, in one word."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.sensor.parameters import SensorParameters


def contact_states(
    heights: NDArray[np.float64],
    sizes: NDArray[np.float64],
    blocked: NDArray[np.bool_],
    parameters: SensorParameters,
) -> NDArray[np.str_]:
    """Name the state (n,) of each touch, one of `tables.CONTACT_STATES`: the first that holds, in this order.

    ``blocked``: something else of the object is in the way of the approaching sensor.
    ``at_minimum``: the object still penetrates, and the sensor may shrink no further. ``partial``:
    part of the sensor meets nothing within its depth range. ``shrunk``: smaller than the largest
    square. ``full``: the largest square. Heights (n, r, r), above the tangent plane, and sizes (n,)
    are in object radii.
    """
    penetrating = (heights > parameters.penetration_tolerance).any(axis=(1, 2))
    partial = (heights < -parameters.depth_range).any(axis=(1, 2))
    return np.select(
        [blocked, penetrating, partial, sizes < parameters.largest_size],
        ["blocked", "at_minimum", "partial", "shrunk"],
        default="full",
    )
