"""Statistics of the shape of an imprint: moments, contact, and the best quadric."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CONTACT_LEVEL = 0.98
"""Least value of a sensing point in contact."""


def describe_imprint_shape(imprints: NDArray[np.floating]) -> NDArray[np.float64]:
    """Describe imprints by moments, contact, and the best quadric.

    Parameters
    ----------
    imprints : ndarray of shape (n, r, r)
        Imprints, 0 to 1; r is at least 3.

    Returns
    -------
    ndarray of shape (n, 13), float64
        Columns as in `tables.IMPRINT_FEATURES`:

        - mean, standard deviation and skewness;
        - the shares of empty sensing points and of sensing points in contact;
        - second derivatives of the least-squares quadric over the square [-1, 1]²: their sum, the
          difference between the largest and the smallest over all directions, and the difference between columns
          and rows;
        - sizes of the quadric's slopes along columns and along rows;
        - standard deviation of the residual of the quadric;
        - mean absolute differences of neighbours along columns and along rows.

        Each row depends only on its own imprint.
    """
    values = imprints.astype(np.float64)
    count, side, _ = values.shape
    flat = values.reshape(count, -1)
    mean, deviation = flat.mean(axis=1), flat.std(axis=1)
    third = _cube(flat - mean[:, None]).mean(axis=1)
    varies = deviation > 1e-9
    skewness = np.where(varies, third / _cube(np.where(varies, deviation, 1)), 0)
    terms = _quadric_terms(side)
    # No BLAS: its sums depend on the number of rows and on the processor.
    quadric = np.einsum("np,tp->nt", flat, terms) / np.square(terms).sum(axis=1)
    residual = flat - np.einsum("nt,tp->np", quadric, terms)
    along, across, mixed = quadric[:, 3], quadric[:, 5], quadric[:, 4]
    return np.column_stack(
        [
            mean,
            deviation,
            skewness,
            (flat <= 0).mean(axis=1),
            (flat >= CONTACT_LEVEL).mean(axis=1),
            2 * (along + across),
            2 * np.hypot(along - across, mixed),
            2 * (along - across),
            np.abs(quadric[:, 1]),
            np.abs(quadric[:, 2]),
            residual.std(axis=1),
            np.abs(np.diff(values, axis=2)).mean(axis=(1, 2)),
            np.abs(np.diff(values, axis=1)).mean(axis=(1, 2)),
        ]
    )


def _cube(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the third power by products, because the last digit of NumPy's power depends on the processor."""
    return values * values * values


def _quadric_terms(side: int) -> NDArray[np.float64]:
    """Compute 1, u, v, u² - m, uv, v² - m at every sensing point, u along columns: shape (6, side²)."""
    # With m, the mean of u², the terms are orthogonal, so least squares needs no system of equations.
    v, u = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side), indexing="ij")
    mean_square = np.square(u).mean()
    terms = [np.ones_like(u), u, v, u * u - mean_square, u * v, v * v - mean_square]
    return np.stack(terms).reshape(6, -1)
