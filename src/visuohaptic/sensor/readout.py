"""Reading the array out: the row and column network, the amplifier and the converter."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray


def read_grounded(conductances: FloatArray, line_resistance: float) -> FloatArray:
    """Read each cell with all other lines held at zero volts through their line resistance.

    Row i is driven, each column's current is measured, and Kirchhoff's laws hold at all 2r line
    nodes. With ``A = 1 + R diag(rows' sums)`` and ``B = 1 + R diag(columns' sums)`` the currents
    per volt are ``(A - R² G B⁻¹ Gᵀ)⁻¹ G B⁻¹``; without resistance that is G itself. Conductances
    (n, r, r) between row and column lines are at least 0, siemens, as is what is measured; the
    resistance in series with each line is in ohm.
    """
    resolution = conductances.shape[-1]
    columns = 1 + line_resistance * conductances.sum(axis=1, keepdims=True)
    weighted = conductances / columns
    system = -(line_resistance**2) * (weighted @ conductances.transpose(0, 2, 1))
    diagonal = np.arange(resolution)
    system[:, diagonal, diagonal] += 1 + line_resistance * conductances.sum(axis=2)
    return np.linalg.solve(system, weighted)


def read_floating(conductances: FloatArray, stand_off: float) -> FloatArray:
    """Read each cell with all other lines left open: sneak paths at their worst.

    What is measured between row i and column j is the network's effective conductance, one over
    ``L⁺ii + L⁺jj - 2 L⁺ij`` of the Laplacian L of the 2r line nodes. Conductances (n, r, r) are at
    least 0, siemens; to every cell that of an untouched one is added, which is positive.
    """
    cells = conductances + stand_off
    count, resolution = cells.shape[:2]
    laplacian = np.zeros((count, 2 * resolution, 2 * resolution))
    laplacian[:, :resolution, resolution:] = -cells
    laplacian[:, resolution:, :resolution] = -cells.transpose(0, 2, 1)
    diagonal = np.arange(2 * resolution)
    laplacian[:, diagonal, diagonal] = -laplacian.sum(axis=2)
    # Any one node may be the ground: the last column's.
    inverse = np.zeros_like(laplacian)
    inverse[:, :-1, :-1] = np.linalg.inv(laplacian[:, :-1, :-1])
    own = inverse[:, diagonal, diagonal]
    between = own[:, :resolution, None] + own[:, None, resolution:]
    return 1 / (between - 2 * inverse[:, :resolution, resolution:])


def quantise(outputs: FloatArray, bits: int) -> FloatArray:
    """Round to the converter's levels, 0 and full scale being the first and the last, and clip beyond them."""
    steps = 2**bits - 1
    return np.round(np.clip(outputs, 0.0, 1.0) * steps) / steps
