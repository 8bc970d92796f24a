"""Predictions of where people look: fixed sums of features, and sums fitted to other objects."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import minimize

from human_gaze.gazed_objects import COLUMNS, FEATURES, TURNING, GazedObject, GazeSettings
from human_gaze.recordings import GazeError
from human_gaze.surface_measures import correlation
from visuohaptic.attention.registry import CHANNELS, TERMS
from visuohaptic.base.arrays import FloatArray

MOST_FITTED = 1500
"""Points of an object that weights are fitted to, evenly spread over the evaluated ones."""

_RARE = 1e-6
_CONVERGED = 1e-9


@dataclass(frozen=True)
class Predictor:
    """A way to predict where people look, from `features` out of `COLUMNS`.

    Kinds ``floor`` and ``sum`` add features with weight 1, none being the same all over; ``fitted`` is
    log-linear, with weights fitted to other objects, and ``chosen`` uses those features alone that
    `choose_features` keeps there; ``peer`` was predicted by others.
    """

    name: str
    label: str
    features: tuple[str, ...]
    kind: Literal["floor", "sum", "fitted", "chosen", "peer"]

    @property
    def is_fitted(self) -> bool:
        """Whether weights are fitted to other objects."""
        return self.kind in ("fitted", "chosen")


def _of_kind(*kinds: str) -> tuple[str, ...]:
    return tuple(name for name, term in TERMS.items() if term.kind in kinds)


def _turned(features: tuple[str, ...]) -> tuple[str, ...]:
    """Give the same features of objects whose front is turned at random."""
    return tuple(f"turned_{name}" if name in TURNING else name for name in features)


PREDICTORS = (
    Predictor("uniform", "the same all over", (), "floor"),
    Predictor("centre", "nearness to the middle of the view", ("centre",), "floor"),
    Predictor("facing", "facing the eye", ("facing",), "floor"),
    Predictor("curvature", "channel curvature alone", ("curvature",), "sum"),
    Predictor("equal", "our saliency, eight equal weights", tuple(CHANNELS), "sum"),
    Predictor("channels", "channels, fitted", tuple(CHANNELS), "fitted"),
    Predictor("view", "channels, centre and facing", (*CHANNELS, *_of_kind("view")), "fitted"),
    Predictor("place", "place on the object alone", _of_kind("place"), "fitted"),
    Predictor("shape", "all but place", (*CHANNELS, *_of_kind("view", "shape")), "fitted"),
    Predictor(
        "place_turned", "place, front turned at random", _turned(_of_kind("place")), "fitted"
    ),
    Predictor("human_turned", "all, front turned at random", _turned(FEATURES), "fitted"),
    Predictor("human", "all channels and terms", FEATURES, "fitted"),
    Predictor("chosen", "those chosen within the folds", FEATURES, "chosen"),
    Predictor("peer", "the peer's prediction", (), "peer"),
)
"""Every predictor, floors first."""

BY_NAME = {one.name: one for one in PREDICTORS}


def predict(one: GazedObject, predictor: Predictor, weights: Mapping[str, float]) -> FloatArray:
    """Give the saliency of each point over all views; a view that does not see it adds 0.

    A fitted model has the exponential of the features, averaged over the views that see a point, times the
    share of these views. Otherwise it is the mean of the weighted sum, of each view's maximum.
    """
    if one.peer is not None and predictor.kind == "peer":
        return np.where(one.gazed.seen, one.peer, 0.0)
    factors = np.array([weights.get(name, 0.0) for name in COLUMNS])
    if predictor.is_fitted:
        exponent = one.features @ factors
        value = np.exp(exponent - exponent[one.gazed.seen].max())
        return np.where(one.gazed.seen, value, 0.0) * one.visible.mean(axis=0)
    total = np.einsum("k,vkrc->vrc", factors.astype(np.float32), one.planes)
    if not weights:
        total = np.ones_like(total)
    peak = np.where(one.shown, total, 0.0).max(axis=(1, 2), keepdims=True)
    total = total / np.where(peak > 0, peak, 1.0)
    at = np.take_along_axis(total.reshape(len(total), -1), one.cells, axis=1)
    found: FloatArray = (at * one.visible).mean(axis=0, dtype=np.float64)
    return found


def fit_predictor(
    objects: Sequence[GazedObject],
    features: Collection[str],
    tested: Collection[str],
    penalty: float,
) -> dict[str, float]:
    """Fit the weights of a log-linear model to where people looked on some objects.

    A conditional logistic regression: the chance that a moment of looking falls on a point is proportional
    to its area, to the share of views that see it, and to the exponential of its weighted features (McFadden
    1974; for fixations Barthelmé et al. 2013, J. Vision 13(12):1). Channels can't have weights below 0; the
    `penalty` is on squared weights of features in standard deviations. Each object counts the same. Raises
    `GazeError` if there is no object, or one of a family that is `tested`.
    """
    leaked = sorted({one.name for one in objects if one.family in set(tested)})
    if leaked:
        raise GazeError(
            f"{', '.join(leaked)} would be in both parts; weights may be fitted on other objects than "
            "those they are tested on."
        )
    if not objects:
        raise GazeError("there are 0 objects to fit weights to; at least 1 is needed.")
    return _fit(objects, features, penalty, {})[0]


def choose_features(
    objects: Sequence[GazedObject], features: Collection[str], folds: int, penalty: float
) -> tuple[str, ...]:
    """Choose the features to fit weights to, on some objects alone.

    Recursive elimination (Guyon, Weston, Barnhill & Vapnik 2002, Machine Learning 46) of the smallest weight,
    in standard deviations. So many are kept as correlate best with people's time on parts of the objects held
    out in turn, the smallest of equally good numbers; all, with fewer than two families of objects.
    """
    families = assign_folds(objects, folds)
    if len(families) < 2:
        return tuple(features)
    scores = np.zeros(len(features))
    for fold in sorted(set(families.values())):
        training = [one for one in objects if families[one.family] != fold]
        held = [one for one in objects if families[one.family] == fold]
        for weights in _eliminate(training, features, penalty):
            found = [
                correlation(predict(one, BY_NAME["human"], weights), one.gazed) for one in held
            ]
            scores[len(weights) - 1] += sum(found)
    kept = int(scores.argmax()) + 1
    return next(
        tuple(weights) for weights in _eliminate(objects, features, penalty) if len(weights) == kept
    )


def _eliminate(
    objects: Sequence[GazedObject], features: Collection[str], penalty: float
) -> Iterator[dict[str, float]]:
    """Give fitted weights of all features, then without the least of them, down to one."""
    scaled = dict.fromkeys(features, 0.0)
    while scaled:
        weights, scaled = _fit(objects, scaled, penalty, scaled)
        yield weights
        del scaled[min(scaled, key=lambda name: abs(scaled[name]))]


def _fit(
    objects: Sequence[GazedObject],
    features: Collection[str],
    penalty: float,
    start: Mapping[str, float],
) -> tuple[dict[str, float], dict[str, float]]:
    """Give the weights of `fit_predictor`, and the same in standard deviations, as `start` has them."""
    chosen = tuple(name for name in COLUMNS if name in set(features))
    columns = [COLUMNS.index(name) for name in chosen]
    parts = [_example(one, columns) for one in objects]
    rows = np.concatenate([part[0] for part in parts])
    offsets = np.concatenate([part[1] for part in parts])
    shares = np.concatenate([part[2] for part in parts])
    owners = np.repeat(np.arange(len(parts)), [len(part[1]) for part in parts])
    starts = np.searchsorted(owners, np.arange(len(parts)))
    deviation = rows.std(axis=0)
    used = deviation > _RARE
    scaled = np.where(used, (rows - rows.mean(axis=0)) / np.where(used, deviation, 1.0), 0.0)

    def loss(weights: FloatArray) -> tuple[float, FloatArray]:
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
        np.array([start.get(name, 0.0) for name in chosen]),
        jac=True,
        method="L-BFGS-B",
        bounds=bounds,
        options={"maxiter": 500, "ftol": _CONVERGED, "gtol": 1e-6},
    )
    weights = np.where(used, found.x / np.where(used, deviation, 1.0), 0.0)
    both = weights, np.where(used, found.x, 0.0)
    first, second = (dict(zip(chosen, values.tolist(), strict=True)) for values in both)
    return first, second


def assign_folds(objects: Sequence[GazedObject], folds: int) -> dict[str, int]:
    """Give each family of objects its fold, in turn by name, so that no family is in two."""
    families = sorted({one.family for one in objects})
    return {family: place % folds for place, family in enumerate(families)}


def weights_of(
    objects: Sequence[GazedObject], predictor: Predictor, settings: GazeSettings
) -> dict[str, dict[str, float]]:
    """Give a predictor's weights by object: without the fold of a training object, of all for a test object."""
    if not predictor.is_fitted:
        return {one.name: dict.fromkeys(predictor.features, 1.0) for one in objects}
    training = [one for one in objects if not one.is_test]
    fold_of = assign_folds(training, settings.folds)
    held = {one.name: -1 if one.is_test else fold_of[one.family] for one in objects}
    found: dict[str, dict[str, float]] = {}
    for fold in sorted(set(held.values())):
        tested = {one.family for one in objects if held[one.name] == fold}
        others = [one for one in training if held[one.name] != fold]
        features = predictor.features
        if predictor.kind == "chosen":
            features = choose_features(others, features, settings.folds, settings.penalty)
        weights = fit_predictor(others, features, tested, settings.penalty)
        found |= {one.name: weights for one in objects if held[one.name] == fold}
    return found


def _example(one: GazedObject, columns: list[int]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Give features, the logarithm of area times share of views, and shares of time at some points."""
    gazed = one.gazed
    places = np.flatnonzero(gazed.seen & (gazed.area > 0))
    places = places[:: -(-len(places) // MOST_FITTED)]
    features = one.features[places][:, columns]
    offset = np.log(gazed.area[places]) + np.log(one.visible.mean(axis=0)[places])
    time = (gazed.density * gazed.area)[places]
    return features, offset, time / time.sum()
