"""The directional filter bank: ladder steps over the tables of `lattice`.

Arrays here are `(pixels, images)`: pixels flattened in raster order, images last, so that one operation
covers a batch. Only additions and multiplications of whole arrays are used, so that the result of an
image is the same, bit for bit, in every batch.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .filters import LadderStep
from .images import FloatArray
from .lattice import DirectionalTables, Stage


def _convolve(x: FloatArray, taps: tuple[float, ...], axis: int) -> FloatArray:
    """Convolve along an axis, without borders; samples with equal taps are added first."""
    length = len(taps)
    if length == 1:
        return x if taps[0] == 1 else x * x.dtype.type(taps[0])
    span = x.shape[axis] - length + 1
    head: tuple[slice, ...] = (slice(None),) * axis

    windows = [x[(*head, slice(start, start + span))] for start in range(length)]
    joins = [
        np.add if tap == mirrored else np.subtract
        for tap, mirrored in zip(taps, taps[::-1], strict=True)
    ]
    total = joins[0](windows[-1], windows[0])
    total *= taps[0]
    term = np.empty_like(total)
    for k in range(1, length // 2):
        joins[k](windows[-1 - k], windows[k], out=term)
        term *= taps[k]
        total += term
    if length % 2:
        total += np.multiply(windows[length // 2], taps[length // 2], out=term)
    return total


def _spread(y: FloatArray, taps: tuple[float, ...], axis: int) -> FloatArray:
    """Apply the adjoint of `_convolve`."""
    reach = [(0, 0)] * y.ndim
    reach[axis] = (len(taps) - 1,) * 2
    return _convolve(np.pad(y, reach), taps[::-1], axis)


def _filter(pixels: FloatArray, stage: Stage) -> FloatArray:
    """Apply the separable filter of a stage to its rectangle; return only the outputs of its target pixels."""
    rectangle = pixels.take(stage.source, axis=0)
    filtered = _convolve(_convolve(rectangle, stage.step.taps, 1), stage.step.taps, 2)
    flat = filtered.reshape(-1, pixels.shape[1])
    return flat if stage.keep is None else flat.take(stage.keep, axis=0)


def _filter_adjoint(values: FloatArray, stage: Stage, pixels: FloatArray) -> None:
    """Add the adjoint of `_filter` to `pixels`."""
    reach = stage.step.before + stage.step.after
    channels, rows, columns = stage.source.shape
    filtered = np.zeros((channels, rows - reach, columns - reach, values.shape[1]), values.dtype)
    flat = filtered.reshape(-1, values.shape[1])
    flat[slice(None) if stage.keep is None else stage.keep] = values
    rectangle = _spread(_spread(filtered, stage.step.taps, 2), stage.step.taps, 1)
    np.add.at(pixels, stage.source.ravel(), rectangle.reshape(-1, values.shape[1]))


def _gains(step: LadderStep, dtype: np.dtype[Any]) -> tuple[Any, Any]:
    return dtype.type(step.gain), dtype.type(step.weight)


def analyse_directions(pixels: FloatArray, tables: DirectionalTables) -> list[FloatArray]:
    """Split images (rows × columns, images) into bands (rows, columns, images); `pixels` is overwritten."""
    for stage in tables.stages:
        gain, weight = _gains(stage.step, pixels.dtype)
        values = pixels.take(stage.target, axis=0)
        values *= gain
        filtered = _filter(pixels, stage)
        filtered *= weight
        values += filtered
        pixels[stage.target] = values
    return [pixels.take(band, axis=0) for band in tables.bands]


def synthesise_directions(bands: list[FloatArray], tables: DirectionalTables) -> FloatArray:
    """Invert `analyse_directions`: undo the steps of the ladder in reverse order."""
    pixels = _gather(bands, tables)
    for stage in reversed(tables.stages):
        gain, weight = _gains(stage.step, pixels.dtype)
        pixels[stage.target] = (pixels[stage.target] - weight * _filter(pixels, stage)) / gain
    return pixels


def adjoin_directions(bands: list[FloatArray], tables: DirectionalTables) -> FloatArray:
    """Apply the adjoint (the matrix transpose) of `analyse_directions`."""
    pixels = _gather(bands, tables)
    for stage in reversed(tables.stages):
        gain, weight = _gains(stage.step, pixels.dtype)
        values = pixels[stage.target]
        pixels[stage.target] = gain * values
        _filter_adjoint(weight * values, stage, pixels)
    return pixels


def _gather(bands: list[FloatArray], tables: DirectionalTables) -> FloatArray:
    count = sum(band.size for band in tables.bands)
    pixels = np.zeros((count, bands[0].shape[-1]), bands[0].dtype)
    for band, values in zip(tables.bands, bands, strict=True):
        pixels[band] = values
    return pixels
