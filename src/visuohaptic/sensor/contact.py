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
    """Name the state of each touch; the first that holds, in this order.

    ``blocked``: something else of the object is in the way of the approaching
    sensor. ``at_minimum``: the object still penetrates, and the sensor may shrink no further.
    ``partial``: part of the sensor meets nothing within its depth range.
    ``shrunk``: smaller than the largest square. ``full``: the largest square.

    Parameters
    ----------
    heights : numpy.ndarray
        Shape (n, r, r), float64, object radii: surface above the tangent plane.
    sizes : numpy.ndarray
        Shape (n,), float64, object radii.
    blocked : numpy.ndarray
        Shape (n,), bool: whether the way in is obstructed.
    parameters : SensorParameters
        The sensor's measures.

    Returns
    -------
    numpy.ndarray
        Shape (n,), str: names among `tables.CONTACT_STATES`.
    """
    penetrating = (heights > parameters.penetration_tolerance).any(axis=(1, 2))
    partial = (heights < -parameters.depth_range).any(axis=(1, 2))
    return np.select(
        [blocked, penetrating, partial, sizes < parameters.largest_size],
        ["blocked", "at_minimum", "partial", "shrunk"],
        default="full",
    )
