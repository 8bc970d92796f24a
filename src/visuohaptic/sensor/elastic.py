"""The elastic cover: from indentation to pressure, by two classic models.

The Winkler foundation is a bed of independent springs. The elastic half-space couples all points by Boussinesq's
solution, so the cover also deforms beside the contact.
"""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray

# Half-space: a touch is solved if an iteration changes the sum of pressures by less than this share.
_CONVERGED = 1e-6
# Half-space: most iterations; contacts of 32 × 32 cells need some 40.
_ITERATIONS = 500


def winkler_pressures(
    indentations: FloatArray, modulus_pa: float, poisson_ratio: float, thickness_m: float
) -> FloatArray:
    """Compute the pressure on a thin layer that is bonded to a rigid backing.

    ``p = w E (1 - ν) / ((1 + ν)(1 - 2ν) h)``: the layer can't bulge sideways, so its modulus is that of confined
    compression (Johnson, Contact Mechanics, 1985, section 4.3).

    Parameters
    ----------
    indentations : ndarray of shape (n, r, r)
        Overlap w of object and cover, metres; negative for a gap.
    modulus_pa : float
        Young's modulus E, pascal.
    poisson_ratio : float
        Poisson's ratio ν, below 0.5.
    thickness_m : float
        Thickness h, metres.

    Returns
    -------
    ndarray of shape (n, r, r)
        Pressure, pascal.
    """
    nu = poisson_ratio
    confined = modulus_pa * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    return confined / thickness_m * np.maximum(indentations, 0.0)


def half_space_pressures(
    indentations: FloatArray, cell_edges_m: FloatArray, modulus_pa: float, poisson_ratio: float
) -> FloatArray:
    """Compute the pressure of a rigid object on an elastic half-space.

    The pressures are at least 0. Their displacements equal the indentation at cells with pressure, and are no smaller
    elsewhere. They are solved by the conjugate gradient method of Polonsky and Keer (Wear 231, 1999) for a given
    displacement, with convolutions by FFT on the doubled grid.

    Parameters
    ----------
    indentations : ndarray of shape (n, r, r)
        Overlap of object and cover, metres; negative for a gap.
    cell_edges_m : ndarray of shape (n,)
        Edge of a sensing cell, metres; pressure is constant over a cell.
    modulus_pa : float
        Young's modulus, pascal.
    poisson_ratio : float
        Poisson's ratio.

    Returns
    -------
    ndarray of shape (n, r, r)
        Pressure, pascal.
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
    """Compute the displacements (2r, 2r) of the half-space at the cells' centres under pressure on one cell.

    The unit is (1 - ν²) × pressure × cell edge / πE. The lags along each axis are 0, 1, …, r - 1, -r, …, -1. The
    formula is A. E. H. Love's integral of Boussinesq's point load over a rectangle (Johnson, Contact Mechanics, 1985,
    equation 3.25).
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
    # arcsinh equals the logarithm in Johnson's equation, without cancellation.
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
