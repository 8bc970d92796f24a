"""Predict where people look by sums of features, with fixed weights or with weights fitted to other objects."""

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
"""Largest number of points of an object to which weights are fitted, evenly spread over the evaluated points."""

_RARE = 1e-6
_CONVERGED = 1e-9


@dataclass(frozen=True)
class Predictor:
    """A method to predict where people look.

    Attributes
    ----------
    name, label : str
        Name in tables, and words for people.
    features : tuple of str
        Features out of `COLUMNS`.
    kind : {"floor", "sum", "fitted", "chosen", "peer"}
        ``floor`` and ``sum`` add the features with weight 1; without features the prediction is constant. ``fitted`` is
        log-linear with weights fitted to other objects. ``chosen`` is the same with only the features of
        `choose_features`. ``peer`` is a prediction of others.
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
    """Return the names of the same features of objects with the front turned at random."""
    return tuple(f"turned_{name}" if name in TURNING else name for name in features)


PREDICTORS = (
    Predictor("uniform", "constant", (), "floor"),
    Predictor("centre", "nearness to the middle of the view", ("centre",), "floor"),
    Predictor("facing", "facing the eye", ("facing",), "floor"),
    Predictor("curvature", "channel curvature", ("curvature",), "sum"),
    Predictor("equal", "eight channels, equal weights", tuple(CHANNELS), "sum"),
    Predictor("channels", "eight channels, fitted", tuple(CHANNELS), "fitted"),
    Predictor(
        "view", "eight channels, nearness and facing", (*CHANNELS, *_of_kind("view")), "fitted"
    ),
    Predictor("place", "position terms", _of_kind("place"), "fitted"),
    Predictor(
        "shape", "all except position terms", (*CHANNELS, *_of_kind("view", "shape")), "fitted"
    ),
    Predictor(
        "place_turned",
        "position terms, front turned at random",
        _turned(_of_kind("place")),
        "fitted",
    ),
    Predictor("human_turned", "all, front turned at random", _turned(FEATURES), "fitted"),
    Predictor("human", "all channels and terms", FEATURES, "fitted"),
    Predictor("chosen", "channels and terms selected per fold", FEATURES, "chosen"),
    Predictor("peer", "the peer's prediction", (), "peer"),
)
"""All predictors, floors first."""

BY_NAME = {predictor.name: predictor for predictor in PREDICTORS}


def predict(gazed: GazedObject, predictor: Predictor, weights: Mapping[str, float]) -> FloatArray:
    """Compute the saliency (n,) of each point of an object over all views.

    A fitted predictor averages the features over the views that see a point. Its saliency is the exponential of their
    weighted sum, times the share of these views. Other predictors divide the weighted sum of each view by its maximum,
    and average over all views; a view that does not see the point adds 0. `weights` are by feature; a missing weight
    is 0.
    """
    if gazed.peer is not None and predictor.kind == "peer":
        return np.where(gazed.gazed.seen, gazed.peer, 0.0)
    factors = np.array([weights.get(name, 0.0) for name in COLUMNS])
    if predictor.is_fitted:
        exponent = gazed.features @ factors
        value = np.exp(exponent - exponent[gazed.gazed.seen].max())
        return np.where(gazed.gazed.seen, value, 0.0) * gazed.visible.mean(axis=0)
    total = np.einsum("k,vkrc->vrc", factors.astype(np.float32), gazed.planes)
    if not weights:
        total = np.ones_like(total)
    peak = np.where(gazed.shown, total, 0.0).max(axis=(1, 2), keepdims=True)
    total = total / np.where(peak > 0, peak, 1.0)
    at_points = np.take_along_axis(total.reshape(len(total), -1), gazed.cells, axis=1)
    saliency: FloatArray = (at_points * gazed.visible).mean(axis=0, dtype=np.float64)
    return saliency


def fit_predictor(
    objects: Sequence[GazedObject],
    features: Collection[str],
    tested: Collection[str],
    penalty: float,
) -> dict[str, float]:
    """Fit the weights of a log-linear model to where people looked.

    The model is a conditional logistic regression (McFadden 1974; for fixations Barthelmé et al. 2013, J. Vision
    13(12):1). The probability that people look at a point is proportional to its area, to the share of views that see
    the point, and to the exponential of its weighted features. All objects have the same influence.

    Parameters
    ----------
    objects : sequence of GazedObject
        Training objects.
    features : collection of str
        Names out of `COLUMNS`. Weights of channels are at least 0.
    tested : collection of str
        Families of objects on which the weights will be tested.
    penalty : float
        Penalty on squared weights of standardised features.

    Returns
    -------
    dict of str to float
        Weight of each feature.

    Raises
    ------
    GazeError
        If there is no object, or an object belongs to a tested family.
    """
    leaked = sorted({gazed.name for gazed in objects if gazed.family in set(tested)})
    if leaked:
        raise GazeError(
            f"{', '.join(leaked)} would be in training and test; weights may only be fitted on objects of other "
            "families than the tested objects."
        )
    if not objects:
        raise GazeError("There are 0 objects to fit weights to; at least 1 is needed.")
    return _fit(objects, features, penalty, {})[0]


def choose_features(
    objects: Sequence[GazedObject], features: Collection[str], folds: int, penalty: float
) -> tuple[str, ...]:
    """Return the features that predict held-out objects best.

    Features with the smallest standardised weight are eliminated one by one (Guyon, Weston, Barnhill & Vapnik 2002,
    Machine Learning 46). The number of features that are kept has the largest correlation with people's time on
    held-out objects; of equally good numbers, the smallest. With fewer than two families of objects all features are
    kept. Only `objects` are used.
    """
    families = assign_folds(objects, folds)
    if len(families) < 2:
        return tuple(features)
    scores = np.zeros(len(features))
    for fold in sorted(set(families.values())):
        training = [gazed for gazed in objects if families[gazed.family] != fold]
        held_out = [gazed for gazed in objects if families[gazed.family] == fold]
        for weights in _eliminate(training, features, penalty):
            scores[len(weights) - 1] += sum(
                correlation(predict(gazed, BY_NAME["human"], weights), gazed.gazed)
                for gazed in held_out
            )
    kept = int(scores.argmax()) + 1
    return next(
        tuple(weights) for weights in _eliminate(objects, features, penalty) if len(weights) == kept
    )


def _eliminate(
    objects: Sequence[GazedObject], features: Collection[str], penalty: float
) -> Iterator[dict[str, float]]:
    """Yield fitted weights of all features, then without the feature of the smallest weight, down to one feature."""
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
    """Return the weights of `fit_predictor`, and the weights of standardised features, from which `start` begins."""
    chosen = tuple(name for name in COLUMNS if name in set(features))
    columns = [COLUMNS.index(name) for name in chosen]
    examples = [_example(gazed, columns) for gazed in objects]
    rows, offsets, shares = (np.concatenate(arrays) for arrays in zip(*examples, strict=True))
    owners = np.repeat(np.arange(len(examples)), [len(offset) for _, offset, _ in examples])
    starts = np.searchsorted(owners, np.arange(len(examples)))
    deviation = rows.std(axis=0)
    used = deviation > _RARE
    scaled = np.where(used, (rows - rows.mean(axis=0)) / np.where(used, deviation, 1.0), 0.0)

    def loss(weights: FloatArray) -> tuple[float, FloatArray]:
        exponent = offsets + scaled @ weights
        exponent -= np.maximum.reduceat(exponent, starts)[owners]
        value = np.exp(exponent)
        total = np.add.reduceat(value, starts)[owners]
        excess = value / total - shares
        fit = -shares @ (exponent - np.log(total)) / len(examples)
        slope = scaled.T @ excess / len(examples)
        return float(fit + penalty * weights @ weights), slope + 2 * penalty * weights

    bounds = [(0.0, None) if name in CHANNELS else (None, None) for name in chosen]
    minimum = minimize(
        loss,
        np.array([start.get(name, 0.0) for name in chosen]),
        jac=True,
        method="L-BFGS-B",
        bounds=bounds,
        options={"maxiter": 500, "ftol": _CONVERGED, "gtol": 1e-6},
    )
    standardised = np.where(used, minimum.x, 0.0)
    weights = np.where(used, minimum.x / np.where(used, deviation, 1.0), 0.0)
    return (
        dict(zip(chosen, weights.tolist(), strict=True)),
        dict(zip(chosen, standardised.tolist(), strict=True)),
    )


def assign_folds(objects: Sequence[GazedObject], folds: int) -> dict[str, int]:
    """Return the fold of each family of objects: families take turns in the order of their names."""
    families = sorted({gazed.family for gazed in objects})
    return {family: index % folds for index, family in enumerate(families)}


def weights_of(
    objects: Sequence[GazedObject], predictor: Predictor, settings: GazeSettings
) -> dict[str, dict[str, float]]:
    """Return the weights of a predictor by object.

    The weights of a training object are fitted without the fold of the object. The weights of a test object are fitted to
    all training objects.
    """
    if not predictor.is_fitted:
        return {gazed.name: dict.fromkeys(predictor.features, 1.0) for gazed in objects}
    training = [gazed for gazed in objects if not gazed.is_test]
    fold_of_family = assign_folds(training, settings.folds)
    fold_of = {
        gazed.name: -1 if gazed.is_test else fold_of_family[gazed.family] for gazed in objects
    }
    weights_by_object: dict[str, dict[str, float]] = {}
    for fold in sorted(set(fold_of.values())):
        tested = {gazed.family for gazed in objects if fold_of[gazed.name] == fold}
        fitted_on = [gazed for gazed in training if fold_of[gazed.name] != fold]
        features = predictor.features
        if predictor.kind == "chosen":
            features = choose_features(fitted_on, features, settings.folds, settings.penalty)
        weights = fit_predictor(fitted_on, features, tested, settings.penalty)
        weights_by_object |= {
            gazed.name: weights for gazed in objects if fold_of[gazed.name] == fold
        }
    return weights_by_object


def _example(gazed: GazedObject, columns: list[int]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return features, log of area times share of views, and share of time at up to `MOST_FITTED` points."""
    surface = gazed.gazed
    points = np.flatnonzero(surface.seen & (surface.area > 0))
    points = points[:: -(-len(points) // MOST_FITTED)]
    features = gazed.features[points][:, columns]
    offset = np.log(surface.area[points]) + np.log(gazed.visible.mean(axis=0)[points])
    time = (surface.density * surface.area)[points]
    return features, offset, time / time.sum()
