"""The sensing cells: from pressure to the conductance of force sensing resistors.

Outputs are in units of full scale: the output at the full-scale pressure is 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def respond_to_force(
    pressures: NDArray[np.float64], break_pressure: float, saturation: float
) -> NDArray[np.float64]:
    """Give the conductance of force sensing resistors.

    ``G ∝ p / (1 + p / p_sat)`` at or above the break pressure, none below: conductance is about linear in
    force between break force and saturation (Interlink, FSR Integration Guide).

    Parameters
    ----------
    pressures : numpy.ndarray
        Any shape, float64, of full scale, at least 0.
    break_pressure : float
        Least pressure that makes a cell conduct, of full scale.
    saturation : float
        Full-scale pressure over the pressure at which conductance is half of linear; 0 is linear.

    Returns
    -------
    numpy.ndarray
        The same shape, float64, of the conductance at full-scale pressure.
    """
    conducting = pressures >= break_pressure
    return np.where(conducting, pressures * ((1 + saturation) / (1 + saturation * pressures)), 0.0)


def scatter_gains(
    outputs: NDArray[np.float64], scatter: float, deviates: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Give each cell its own gain.

    Parameters
    ----------
    outputs : numpy.ndarray
        Shape (n, r, r), float64, of full scale.
    scatter : float
        Standard deviation of the gains; parts of one batch scatter by some 6 %
        (Interlink data sheet).
    deviates : numpy.ndarray
        Shape (r, r), float64: standard normal deviates, the sensor's own.

    Returns
    -------
    numpy.ndarray
        Shape (n, r, r), float64; no gain is negative.
    """
    return outputs * np.maximum(1 + scatter * deviates, 0.0)


def remember_peak(
    outputs: NDArray[np.float64], peaks: NDArray[np.float64], excess: float
) -> NDArray[np.float64]:
    """Give the output on release from a peak: hysteresis.

    ``y = x + 2 e x (1 - x / m)`` for the peak m: no excess at the peak and at zero, the share e
    at half the peak. A press to m and back encloses the area ``e m² / 3``. The
    memory is of the peak alone, as the conditioning of filled rubber; pressing again below the peak follows the release.

    Parameters
    ----------
    outputs, peaks : numpy.ndarray
        One shape, float64, of full scale: output now, and at its highest since the cell was free.
    excess : float
        Share e; some 10 % (Interlink data sheet).

    Returns
    -------
    numpy.ndarray
        The same shape, float64.
    """
    share = np.divide(outputs, peaks, out=np.ones_like(outputs), where=peaks > outputs)
    return outputs + 2 * excess * outputs * (1 - share)


def drift(
    outputs: NDArray[np.float64], held_s: float, reference_s: float, per_decade: float
) -> NDArray[np.float64]:
    """Let outputs creep with the logarithm of the time under load.

    ``y = x (1 + k log10(t / t0))`` after the reference time t0; less than 5 % a decade
    (Interlink data sheet).

    Parameters
    ----------
    outputs : numpy.ndarray
        Any shape, float64, of full scale.
    held_s, reference_s : float
        Time t under load and reference time t0, seconds.
    per_decade : float
        Change k over ten times the time.

    Returns
    -------
    numpy.ndarray
        The same shape, float64.
    """
    decades = np.log10(max(held_s / reference_s, 1.0))
    return outputs * (1 + per_decade * decades)
