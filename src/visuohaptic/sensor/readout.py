"""Readout of the array: the network of rows and columns, and the converter."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray


def read_grounded(conductances: FloatArray, line_resistance: float) -> FloatArray:
    """Read each cell with all other lines held at 0 V through their line resistance.

    Row i is driven, and the current of each column is measured. Kirchhoff's laws at all 2r line nodes give the
    currents per volt ``(A - R² G B⁻¹ Gᵀ)⁻¹ G B⁻¹``, with ``A = 1 + R diag(row sums of G)`` and
    ``B = 1 + R diag(column sums of G)``. Without resistance they equal G.

    Parameters
    ----------
    conductances : ndarray of shape (n, r, r)
        Conductances G between row and column lines, siemens, at least 0.
    line_resistance : float
        Resistance R in series with each line, ohm.

    Returns
    -------
    ndarray of shape (n, r, r)
        Measured conductances, siemens.
    """
    resolution = conductances.shape[-1]
    columns = 1 + line_resistance * conductances.sum(axis=1, keepdims=True)
    weighted = conductances / columns
    system = -(line_resistance**2) * (weighted @ conductances.transpose(0, 2, 1))
    diagonal = np.arange(resolution)
    system[:, diagonal, diagonal] += 1 + line_resistance * conductances.sum(axis=2)
    return np.linalg.solve(system, weighted)


def read_floating(conductances: FloatArray, stand_off: float) -> FloatArray:
    """Read each cell with all other lines open, which gives the most crosstalk.

    The reading of row i and column j is the effective conductance of the network between both lines:
    ``1 / (L⁺ii + L⁺jj - 2 L⁺ij)``, where L is the Laplacian of the 2r line nodes.

    Parameters
    ----------
    conductances : ndarray of shape (n, r, r)
        Conductances of the cells, siemens, at least 0.
    stand_off : float
        Conductance of an untouched cell, siemens, above 0; it is added to every cell.

    Returns
    -------
    ndarray of shape (n, r, r)
        Measured conductances, siemens.
    """
    cells = conductances + stand_off
    count, resolution = cells.shape[:2]
    laplacian = np.zeros((count, 2 * resolution, 2 * resolution))
    laplacian[:, :resolution, resolution:] = -cells
    laplacian[:, resolution:, :resolution] = -cells.transpose(0, 2, 1)
    diagonal = np.arange(2 * resolution)
    laplacian[:, diagonal, diagonal] = -laplacian.sum(axis=2)
    # Any node may be the ground; here the last column.
    inverse = np.zeros_like(laplacian)
    inverse[:, :-1, :-1] = np.linalg.inv(laplacian[:, :-1, :-1])
    own = inverse[:, diagonal, diagonal]
    between = own[:, :resolution, None] + own[:, None, resolution:]
    return 1 / (between - 2 * inverse[:, :resolution, resolution:])


def quantise(outputs: FloatArray, bits: int) -> FloatArray:
    """Clip outputs to 0 to 1, full scale, and round them to the 2**bits levels of the converter."""
    steps = 2**bits - 1
    return np.round(np.clip(outputs, 0.0, 1.0) * steps) / steps
