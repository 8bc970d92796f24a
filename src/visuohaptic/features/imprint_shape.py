"""Statistics of an imprint beside its contourlet bands: how much is touched, how it bends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CONTACT_LEVEL = 0.98
"""From this value on a sensing point counts as being in contact."""


def describe_imprint_shape(imprints: NDArray[np.floating]) -> NDArray[np.float64]:
    """Describe imprints (n, r, r), in [0, 1], by moments, contact, and the best quadric; r > 2.

    Returns (n, 13), columns as in `tables.IMPRINT_FEATURES`: mean, deviation and skewness; the shares
    of empty and of touching points; of the best quadric over the square [-1, 1]² the sum of its
    second derivatives, the size of their difference over all directions, and the difference between
    columns and rows; its slopes' sizes along columns and rows; the deviation that it leaves; mean
    steps between neighbours along columns and rows. Each row depends only on its own imprint.
    """
    values = imprints.astype(np.float64)
    count, side, _ = values.shape
    flat = values.reshape(count, -1)
    mean, deviation = flat.mean(axis=1), flat.std(axis=1)
    third = _cube(flat - mean[:, None]).mean(axis=1)
    varies = deviation > 1e-9
    skewness = np.where(varies, third / _cube(np.where(varies, deviation, 1)), 0)
    terms = _quadric_terms(side)
    # Without BLAS: a row's sums must not depend on how many rows there are, nor on the processor.
    quadric = np.einsum("np,tp->nt", flat, terms) / np.square(terms).sum(axis=1)
    rest = flat - np.einsum("nt,tp->np", quadric, terms)
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
            rest.std(axis=1),
            np.abs(np.diff(values, axis=2)).mean(axis=(1, 2)),
            np.abs(np.diff(values, axis=1)).mean(axis=(1, 2)),
        ]
    )


def _cube(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the third power by products; the last digit of NumPy's power depends on the processor."""
    return values * values * values


def _quadric_terms(side: int) -> NDArray[np.float64]:
    """Compute 1, u, v, u² - m, uv, v² - m at every sensing point, u along columns, shape (6, side²)."""
    # m, the mean of u², makes the terms orthogonal: each coefficient of the best quadric is a quotient.
    v, u = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side), indexing="ij")
    centre = np.square(u).mean()
    terms = [np.ones_like(u), u, v, u * u - centre, u * v, v * v - centre]
    return np.stack(terms).reshape(6, -1)
