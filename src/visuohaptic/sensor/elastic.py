"""The elastic cover: from how deep the object is pressed in to pressure.

Two classic models. The Winkler foundation is a bed of independent springs; the elastic
half-space couples all points by Boussinesq's solution, so a cover also gives way beside the contact.
"""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray

# Half-space: relative change of the pressure's sum at which a touch counts as solved, and the
# iterations after which it is left as it is; contacts of 32 × 32 cells need some 40.
_CONVERGED = 1e-6
_ITERATIONS = 500


def winkler_pressures(
    indentations: FloatArray, modulus_pa: float, poisson_ratio: float, thickness_m: float
) -> FloatArray:
    """Give the pressure (n, r, r), pascal, on a thin layer bonded to a rigid backing, spring by spring.

    ``p = w E (1 - ν) / ((1 + ν)(1 - 2ν) h)``: the layer can't bulge sideways, so the modulus of
    confined compression counts (Johnson, Contact Mechanics, 1985, section 4.3). `indentations` (n,
    r, r) are the overlap of object and cover, metres, negative for a gap; Poisson's ratio is below
    0.5.
    """
    nu = poisson_ratio
    confined = modulus_pa * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    return confined / thickness_m * np.maximum(indentations, 0.0)


def half_space_pressures(
    indentations: FloatArray, cell_edges_m: FloatArray, modulus_pa: float, poisson_ratio: float
) -> FloatArray:
    """Give the pressure (n, r, r), pascal, on an elastic half-space that a rigid object is pressed into.

    Finds pressures ``p >= 0`` whose displacements equal the indentation wherever ``p > 0`` and are
    no less elsewhere, by the conjugate gradient method of Polonsky and Keer (Wear 231, 1999) with
    the displacement given; convolution by FFT on the doubled grid. `indentations` (n, r, r) are the
    overlap of object and cover, metres, negative for a gap; over a cell, of the edges
    `cell_edges_m` (n,), pressure is constant.
    """
    count, resolution = indentations.shape[:2]
    flat = indentations.reshape(count, -1)
    spectrum = _kernel_spectrum(resolution)
    loads = np.maximum(flat, 0.0)
    search = np.zeros_like(loads)
    previous = np.ones(count)
    conjugate = np.zeros(count)
    pending = np.flatnonzero(loads.any(axis=1))
    for _ in range(_ITERATIONS):
        if not len(pending):
            break
        load = loads[pending]
        gap = _displace(load, spectrum) - flat[pending]
        touching = load > 0
        residual = np.where(touching, gap, 0.0)
        strength = (residual * residual).sum(axis=1)
        keep = conjugate[pending] * strength / previous[pending]
        step = np.where(touching, residual + keep[:, None] * search[pending], 0.0)
        across = (_displace(step, spectrum) * step).sum(axis=1)
        along = (residual * step).sum(axis=1)
        length = np.divide(along, across, out=np.zeros_like(along), where=across > 0)
        fresh = np.maximum(load - length[:, None] * step, 0.0)
        overlapping = (fresh == 0) & (gap < 0)
        fresh -= length[:, None] * np.where(overlapping, gap, 0.0)
        loads[pending], search[pending], previous[pending] = fresh, step, strength
        conjugate[pending] = np.where(overlapping.any(axis=1), 0.0, 1.0)
        change = np.abs(fresh - load).sum(axis=1)
        pending = pending[(change > _CONVERGED * fresh.sum(axis=1)) & (strength > 0)]
    stiffness = np.pi * modulus_pa / (1 - poisson_ratio**2) / cell_edges_m
    return (stiffness[:, None] * loads).reshape(indentations.shape)


def boussinesq_kernel(resolution: int) -> FloatArray:
    """Give the half-space's displacements (2r, 2r) under pressure on one square cell.

    A. E. H. Love's integral of Boussinesq's point load over a rectangle, as in Johnson, Contact
    Mechanics (1985), equation 3.25, at the cells' centres. In units of (1 - ν²) pressure × cell
    edge / πE, at the lags 0, 1, …, r - 1, -r, …, -1 along each axis.
    """
    lags = np.roll(np.arange(-resolution, resolution, dtype=np.float64), resolution)
    x, y = lags[:, None], lags[None, :]
    return (
        _edge_term(x + 0.5, y)
        - _edge_term(x - 0.5, y)
        + _edge_term(y + 0.5, x)
        - _edge_term(y - 0.5, x)
    )


def _edge_term(distance: FloatArray, along: FloatArray) -> FloatArray:
    # asinh is the logarithm of Johnson's equation without its cancellation.
    far = np.abs(distance)
    return distance * (np.arcsinh((along + 0.5) / far) - np.arcsinh((along - 0.5) / far))


def _kernel_spectrum(resolution: int) -> FloatArray:
    # The kernel is even along both axes, so its spectrum is real.
    return np.fft.rfft2(boussinesq_kernel(resolution)).real


def _displace(loads: FloatArray, spectrum: FloatArray) -> FloatArray:
    doubled = spectrum.shape[0]
    resolution = doubled // 2
    grid = loads.reshape(-1, resolution, resolution)
    shape = (doubled, doubled)
    padded = np.fft.irfft2(np.fft.rfft2(grid, shape) * spectrum, shape)
    return padded[:, :resolution, :resolution].reshape(loads.shape)
