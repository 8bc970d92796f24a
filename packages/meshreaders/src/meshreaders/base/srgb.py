"""Convert colours between sRGB (IEC 61966-2-1) and linear light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray
from meshreaders.base.powers import power

_POWER = 2.4
_OFFSET = 0.055
# Dark colours lie on a line: its slope, and its end in sRGB and in linear light.
_SLOPE = 12.92
_DARK = 0.04045
_DARK_LIGHT = 0.0031308


def encode_srgb(linear: FloatArray) -> FloatArray:
    """Convert linear light, 0 to 1, of any shape to sRGB, 0 to 1."""
    bright = (1.0 + _OFFSET) * power(linear, 1 / _POWER) - _OFFSET
    return np.where(linear <= _DARK_LIGHT, _SLOPE * linear, bright)


def decode_srgb(encoded: FloatArray) -> FloatArray:
    """Convert sRGB, 0 to 1, of any shape to linear light, 0 to 1."""
    bright = power((encoded + _OFFSET) / (1.0 + _OFFSET), _POWER)
    return np.where(encoded <= _DARK, encoded / _SLOPE, bright)


def encode_bytes(linear: FloatArray) -> NDArray[np.uint8]:
    """Convert linear light, 0 to 1, of any shape to the nearest sRGB byte, 0 to 255."""
    return np.searchsorted(_BETWEEN_BYTES, linear, side="right").astype(np.uint8)


def dim_srgb(encoded: FloatArray, irradiance: FloatArray) -> FloatArray:
    """Compute sRGB colours (n, 3), 0 to 1, under a share (n,), 0 to 1, of full light.

    Full light returns the same bits as `encoded`.
    """
    # Channel by channel, so that NumPy's inner loops run along the colours.
    encoded = np.ascontiguousarray(encoded.T)
    # Decoding is the inverse power of encoding, so only the share needs a power.
    dimmed = (encoded + _OFFSET) * power(irradiance, 1 / _POWER)
    dimmed -= _OFFSET
    dark = np.flatnonzero(np.minimum(encoded, dimmed) <= _DARK)
    stored = encoded.take(dark)
    light = stored / _SLOPE
    # Only bright colours are decoded by a power.
    bright = np.flatnonzero(stored > _DARK)
    light[bright] = decode_srgb(stored.take(bright))
    light *= irradiance.take(dark % len(irradiance))
    dimmed.reshape(-1)[dark] = _SLOPE * light
    return np.where(irradiance == 1.0, encoded, dimmed).T


_BETWEEN_BYTES = decode_srgb(np.arange(0.5, 255.0) / 255.0)
