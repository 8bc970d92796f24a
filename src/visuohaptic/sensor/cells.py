"""The sensing cells: from pressure to the conductance of force sensing resistors.

Outputs are in units of full scale: the output at the full-scale pressure is 1.
"""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray


def respond_to_force(pressures: FloatArray, break_pressure: float, saturation: float) -> FloatArray:
    """Give the conductance of force sensing resistors under pressures of full scale, of any shape.

    ``G ∝ p / (1 + p / p_sat)`` at or above the break pressure, none below: conductance is about
    linear in force between break force and saturation (Interlink, FSR Integration Guide).
    `saturation` is the full-scale pressure over the pressure at which conductance is half of
    linear; 0 is linear.
    """
    conducting = pressures >= break_pressure
    return np.where(conducting, pressures * ((1 + saturation) / (1 + saturation * pressures)), 0.0)


def scatter_gains(outputs: FloatArray, scatter: float, deviates: FloatArray) -> FloatArray:
    """Give each cell of outputs (n, r, r) its own gain, none of them negative.

    `scatter` is the gains' standard deviation; parts of one batch scatter by some 6 % (Interlink
    data sheet). `deviates` (r, r) are the sensor's own standard normal ones.
    """
    return outputs * np.maximum(1 + scatter * deviates, 0.0)


def remember_peak(outputs: FloatArray, peaks: FloatArray, excess: float) -> FloatArray:
    """Give the output on release from a peak: hysteresis.

    ``y = x + 2 e x (1 - x / m)`` for the peak m: no excess at the peak and at zero, the share e at
    half the peak, some 10 % (Interlink data sheet). A press to m and back encloses the area ``e m²
    / 3``. The memory is of the peak alone, as the conditioning of filled rubber; pressing again
    below the peak follows the release. Peaks are the highest outputs since the cell was free.
    """
    share = np.divide(outputs, peaks, out=np.ones_like(outputs), where=peaks > outputs)
    return outputs + 2 * excess * outputs * (1 - share)


def drift(outputs: FloatArray, held_s: float, reference_s: float, per_decade: float) -> FloatArray:
    """Let outputs creep with the logarithm of the time under load.

    ``y = x (1 + k log10(t / t0))`` after the reference time t0; less than 5 % a decade (Interlink
    data sheet).
    """
    decades = np.log10(max(held_s / reference_s, 1.0))
    return outputs * (1 + per_decade * decades)
