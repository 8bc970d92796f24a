"""Predictions of where people look: fixed sums of features, and sums fitted to other objects."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from visuohaptic.attention.parameters import CHANNELS
from visuohaptic.attention.term_registry import TERMS
from visuohaptic.errors import GazeError
from visuohaptic.gaze.looking import FEATURES, GazedObject

MOST_FITTED = 1500
"""Points of an object that weights are fitted to, evenly spread over the evaluated ones."""

_RARE = 1e-6
_CONVERGED = 1e-9


@dataclass(frozen=True)
class Predictor:
    """A way to predict where people look.

    Attributes
    ----------
    name, label : str
        What tables and the report call it.
    features : tuple of str
        What it uses, out of `FEATURES`; none for a prediction that is the same all over.
    kind : {"floor", "sum", "fitted"}
        ``floor`` and ``sum`` add features with weight 1; ``fitted`` is log-linear, with weights
        fitted to other objects.
    """

    name: str
    label: str
    features: tuple[str, ...]
    kind: Literal["floor", "sum", "fitted"]


def _of_kind(*kinds: str) -> tuple[str, ...]:
    return tuple(name for name, term in TERMS.items() if term.kind in kinds)


PREDICTORS = (
    Predictor("uniform", "the same all over", (), "floor"),
    Predictor("centre", "nearness to the middle of the view", ("centre",), "floor"),
    Predictor("facing", "facing the eye", ("facing",), "floor"),
    Predictor("curvature", "channel curvature alone", ("curvature",), "sum"),
    Predictor("equal", "our saliency, eight equal weights", CHANNELS, "sum"),
    Predictor("channels", "channels, fitted", CHANNELS, "fitted"),
    Predictor("view", "channels, centre and facing", (*CHANNELS, *_of_kind("view")), "fitted"),
    Predictor("place", "place on the object alone", _of_kind("place"), "fitted"),
    Predictor("shape", "all but place", (*CHANNELS, *_of_kind("view", "shape")), "fitted"),
    Predictor("human", "all channels and terms", FEATURES, "fitted"),
)
"""Every predictor, floors first."""


def predict(
    one: GazedObject, weights: Mapping[str, float], *, exponential: bool
) -> NDArray[np.float64]:
    """Give the saliency of each point over all views; a view that does not see it adds 0.

    A log-linear model has the exponential of the weighted features, averaged over the views that see
    a point, times the share of views that see it: what `fit_predictor` fits. Otherwise it is the mean over
    all views of the weighted sum, as a share of each view's maximum, as the eye has it.
    """
    factors = np.array([weights.get(name, 0.0) for name in FEATURES])
    if exponential:
        exponent = one.features @ factors
        value = np.exp(exponent - exponent[one.gazed.seen].max())
        return np.where(one.gazed.seen, value, 0.0) * one.visible.mean(axis=0)
    total = np.einsum("k,vkrc->vrc", factors.astype(np.float32), one.planes)
    if not weights:
        total = np.ones_like(total)
    peak = np.where(one.shown, total, 0.0).max(axis=(1, 2), keepdims=True)
    total = total / np.where(peak > 0, peak, 1.0)
    at = np.take_along_axis(total.reshape(len(total), -1), one.cells, axis=1)
    found: NDArray[np.float64] = (at * one.visible).mean(axis=0, dtype=np.float64)
    return found


def fit_predictor(
    objects: Sequence[GazedObject],
    features: Collection[str],
    tested: Collection[str],
    penalty: float,
) -> dict[str, float]:
    """Fit the weights of a log-linear model to where people looked on some objects.

    The model is a conditional logistic regression: the chance that a moment of looking falls on
    a point is proportional to the point's area, to the share of views that see it, and to the
    exponential of its weighted features (McFadden 1974; for fixations Barthelmé et al. 2013, J. Vision
    13(12):1). Channels can't have weights below 0. Each object counts the same.

    Parameters
    ----------
    objects : sequence of GazedObject
        Objects to learn from.
    features : collection of str
        Out of `FEATURES`.
    tested : collection of str
        Families of the objects that are used for tests.
    penalty : float
        On the squared weights of features in standard deviations.

    Returns
    -------
    dict of str to float
        Weights by feature.

    Raises
    ------
    GazeError
        If there is no object, or one of a tested family.
    """
    leaked = sorted({one.name for one in objects if one.family in set(tested)})
    if leaked:
        raise GazeError(
            f"{', '.join(leaked)} would be in both parts; weights may be fitted on other objects than "
            "those they are tested on."
        )
    if not objects:
        raise GazeError("there are 0 objects to fit weights to; at least 1 is needed.")
    from scipy.optimize import minimize

    chosen = tuple(name for name in FEATURES if name in set(features))
    columns = [FEATURES.index(name) for name in chosen]
    parts = [_example(one, columns) for one in objects]
    rows = np.concatenate([part[0] for part in parts])
    offsets = np.concatenate([part[1] for part in parts])
    shares = np.concatenate([part[2] for part in parts])
    owners = np.repeat(np.arange(len(parts)), [len(part[1]) for part in parts])
    starts = np.searchsorted(owners, np.arange(len(parts)))
    deviation = rows.std(axis=0)
    used = deviation > _RARE
    scaled = np.where(used, (rows - rows.mean(axis=0)) / np.where(used, deviation, 1.0), 0.0)

    def loss(weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        exponent = offsets + scaled @ weights
        exponent -= np.maximum.reduceat(exponent, starts)[owners]
        value = np.exp(exponent)
        total = np.add.reduceat(value, starts)[owners]
        excess = value / total - shares
        fit = -shares @ (exponent - np.log(total)) / len(parts)
        slope = scaled.T @ excess / len(parts)
        return float(fit + penalty * weights @ weights), slope + 2 * penalty * weights

    bounds = [(0.0, None) if name in CHANNELS else (None, None) for name in chosen]
    found = minimize(
        loss,
        np.zeros(len(chosen)),
        jac=True,
        method="L-BFGS-B",
        bounds=bounds,
        options={"maxiter": 500, "ftol": _CONVERGED, "gtol": 1e-6},
    )
    weights = np.where(used, found.x / np.where(used, deviation, 1.0), 0.0)
    return dict(zip(chosen, weights.tolist(), strict=True))


def assign_folds(objects: Sequence[GazedObject], folds: int) -> dict[str, int]:
    """Give each family of objects its fold, in turn by name, so that no family is in two."""
    families = sorted({one.family for one in objects})
    return {family: place % folds for place, family in enumerate(families)}


def held_out_weights(
    objects: Sequence[GazedObject], predictor: Predictor, folds: int, penalty: float
) -> dict[str, dict[str, float]]:
    """Give, by object, weights that were fitted without the object's fold."""
    fold_of = assign_folds(objects, folds)
    by_fold = {}
    for fold in sorted(set(fold_of.values())):
        tested = {family for family, place in fold_of.items() if place == fold}
        training = [one for one in objects if one.family not in tested]
        by_fold[fold] = fit_predictor(training, predictor.features, tested, penalty)
    return {one.name: by_fold[fold_of[one.family]] for one in objects}


def _example(
    one: GazedObject, columns: list[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Give features, the logarithm of area times share of views, and shares of time at some points."""
    gazed = one.gazed
    places = np.flatnonzero(gazed.seen & (gazed.area > 0))
    places = places[:: -(-len(places) // MOST_FITTED)]
    features = one.features[places][:, columns]
    offset = np.log(gazed.area[places]) + np.log(one.visible.mean(axis=0)[places])
    time = (gazed.density * gazed.area)[places]
    return features, offset, time / time.sum()
