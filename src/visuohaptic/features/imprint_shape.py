"""Statistics of the shape of an imprint: moments, contact, and the best quadric."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.geometry.layouts import Layout

CONTACT_LEVEL = 0.98
"""Least value of a sensing point in contact."""


def describe_imprint_shape(
    imprints: NDArray[np.floating], layout: Layout | None = None
) -> NDArray[np.float64]:
    """Describe imprints by moments, contact, and the best quadric.

    Parameters
    ----------
    imprints : ndarray of shape (n, r, r) or (n, taxels)
        Imprints, 0 to 1; r is at least 3.
    layout : Layout, optional
        The taxels of imprints (n, taxels), on the unrolled pad (`Layout.chart`). Imprints (n, r, r) are those of a square
        grid, and need none.

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
        - mean absolute differences of neighbours along columns and along rows; neighbours of other layouts than the
          square are those of `Layout.pairs`, along columns if x differs more than y.

        Each row depends only on its own imprint.
    """
    values = imprints.astype(np.float64)
    flat = values.reshape(len(values), -1)
    mean, deviation = flat.mean(axis=1), flat.std(axis=1)
    third = _cube(flat - mean[:, None]).mean(axis=1)
    varies = deviation > 1e-9
    skewness = np.where(varies, third / _cube(np.where(varies, deviation, 1)), 0)
    if layout is None:
        terms = _quadric_terms(values.shape[1])
        duals, squares = terms, np.square(terms).sum(axis=1)
        steps = [np.abs(np.diff(values, axis=axis)).mean(axis=(1, 2)) for axis in (2, 1)]
    else:
        terms, duals, squares = _quadric_of(layout)
        steps = [
            np.abs(flat[:, first] - flat[:, second]).sum(axis=1) / max(len(first), 1)
            for first, second in _pairs_along_axes(layout)
        ]
    # No BLAS: its sums depend on the number of rows and on the processor.
    quadric = np.einsum("np,tp->nt", flat, duals) / squares
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
            *steps,
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


def _quadric_of(
    layout: Layout,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Compute the terms 1, u, v, u², uv, v² (6, t) at the taxels, the duals that give the coefficients, and their squares."""
    # The terms are not orthogonal in general, so the duals come from the pseudo-inverse: the least-squares quadric, and the
    # smallest such quadric where the taxels determine no single one.
    u, v = layout.chart[:, 0], -layout.chart[:, 1]
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v])
    return terms, np.asarray(np.linalg.pinv(terms).T, dtype=np.float64), np.ones(6)


def _pairs_along_axes(layout: Layout) -> list[NDArray[np.int64]]:
    """Return the pairs (2, k) of neighbours along columns, and along rows."""
    pairs = layout.pairs
    apart = np.abs(layout.chart[pairs[:, 0]] - layout.chart[pairs[:, 1]])
    along_columns = apart[:, 0] > apart[:, 1]
    return [pairs[along_columns].T, pairs[~along_columns].T]
