"""Colours as they are stored (sRGB, IEC 61966-2-1) and as light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.elementary import power

_POWER = 2.4
_OFFSET = 0.055
# Dark colours are on a line: its slope, and where it ends, as stored and as light.
_SLOPE = 12.92
_DARK = 0.04045
_DARK_LIGHT = 0.0031308


def encode_srgb(linear: FloatArray) -> FloatArray:
    """Encode linear light, 0 to 1, as sRGB."""
    bright = (1.0 + _OFFSET) * power(linear, 1 / _POWER) - _OFFSET
    return np.where(linear <= _DARK_LIGHT, _SLOPE * linear, bright)


def decode_srgb(encoded: FloatArray) -> FloatArray:
    """Decode sRGB to linear light, 0 to 1."""
    bright = power((encoded + _OFFSET) / (1.0 + _OFFSET), _POWER)
    return np.where(encoded <= _DARK, encoded / _SLOPE, bright)


def encode_bytes(linear: FloatArray) -> NDArray[np.uint8]:
    """Encode linear light, 0 to 1, as the nearest of the 256 values of sRGB."""
    return np.searchsorted(_BETWEEN_BYTES, linear, side="right").astype(np.uint8)


def dim_srgb(encoded: FloatArray, irradiance: FloatArray) -> FloatArray:
    """Give sRGB colours (n, 3), 0 to 1, of surfaces in less than full light: of its share (n,), 0 to 1.

    In full light they are exactly what was given.
    """
    # Channel by channel, so that NumPy's inner loops run along the colours.
    encoded = np.ascontiguousarray(encoded.T)
    # The power that decodes is the inverse of the one that encodes, so the light needs one alone.
    dimmed = (encoded + _OFFSET) * power(irradiance, 1 / _POWER)
    dimmed -= _OFFSET
    dark = np.flatnonzero(np.minimum(encoded, dimmed) <= _DARK)
    stored = encoded.take(dark)
    light = stored / _SLOPE
    # Only these have light that is a power.
    bright = np.flatnonzero(stored > _DARK)
    light[bright] = decode_srgb(stored.take(bright))
    light *= irradiance.take(dark % len(irradiance))
    dimmed.reshape(-1)[dark] = _SLOPE * light
    return np.where(irradiance == 1.0, encoded, dimmed).T


_BETWEEN_BYTES = decode_srgb(np.arange(0.5, 255.0) / 255.0)
