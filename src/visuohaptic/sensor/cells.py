"""The sensing cells: from pressure to the conductance of force sensing resistors.

Outputs are in units of full scale: 1 is the output at the full-scale pressure.
"""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray


def respond_to_force(pressures: FloatArray, break_pressure: float, saturation: float) -> FloatArray:
    """Compute the conductance of force sensing resistors under pressure.

    ``G ∝ p / (1 + p / p_sat)`` from the break pressure on, and 0 below: conductance is nearly linear in force between
    break force and saturation (Interlink, FSR Integration Guide).

    Parameters
    ----------
    pressures : ndarray of any shape
        Pressures, of the full-scale pressure.
    break_pressure : float
        Least pressure with conductance, of the full-scale pressure.
    saturation : float
        Full-scale pressure divided by p_sat, at which conductance is half of linear; 0 is linear.

    Returns
    -------
    ndarray
        Outputs, of full scale.
    """
    conducting = pressures >= break_pressure
    return np.where(conducting, pressures * ((1 + saturation) / (1 + saturation * pressures)), 0.0)


def scatter_gains(outputs: FloatArray, scatter: float, deviates: FloatArray) -> FloatArray:
    """Multiply the outputs (n, r, r) by the gain of each cell, which is at least 0.

    `scatter` is the standard deviation of the gains; parts of the same batch scatter by some 6 % (Interlink data
    sheet). `deviates` (r, r) are standard normal deviates of the sensor.
    """
    return outputs * np.maximum(1 + scatter * deviates, 0.0)


def add_hysteresis(outputs: FloatArray, peaks: FloatArray, excess: float) -> FloatArray:
    """Add hysteresis: compute the outputs on release from a peak.

    ``y = x + 2 e x (1 - x / m)`` for the output x, the peak m and the excess e. At half the peak the output is
    larger by the share e, some 10 % (Interlink data sheet). Pressing to m and back encloses the area ``e m² / 3``.
    Only the peak is remembered, as in the conditioning of filled rubber: pressing again below the peak follows the
    curve of release.

    Parameters
    ----------
    outputs : ndarray of any shape
        Outputs without hysteresis, of full scale.
    peaks : ndarray of the same shape
        The highest outputs since the cell was last unloaded.
    excess : float
        The excess e.

    Returns
    -------
    ndarray
        Outputs, of full scale.
    """
    share = np.divide(outputs, peaks, out=np.ones_like(outputs), where=peaks > outputs)
    return outputs + 2 * excess * outputs * (1 - share)


def add_drift(
    outputs: FloatArray, held_s: float, reference_s: float, per_decade: float
) -> FloatArray:
    """Add drift with the logarithm of the time under load.

    ``y = x (1 + k log10(t / t0))`` for the time `held_s` t after the reference time t0; k is below 5 % per decade
    (Interlink data sheet).
    """
    decades = np.log10(max(held_s / reference_s, 1.0))
    return outputs * (1 + per_decade * decades)
