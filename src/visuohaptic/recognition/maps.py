"""Maps, which reduce the features of a touch to a few numbers: one registry entry per map."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.registry import Registry
from visuohaptic.recognition.self_organising_map import (
    SelfOrganisingMap,
    fit_map,
    lattice,
    line,
)


@dataclass(frozen=True)
class Map:
    """A method to reduce a touch to a few numbers.

    Attributes
    ----------
    name : str
        Name in parameters.
    description : str
        Meaning of the numbers.
    fit : callable
        ``fit(touches, settings, generator)`` returns the fitted map. `touches` has the shape (n, k), float64; `settings`
        is the section `recognition.self_organising_map`.
    reduce : callable
        ``reduce(fitted, touches)`` returns the numbers of touches: (n, k) to (n, m).
    rounding_scale : callable, optional
        ``rounding_scale(fitted, input_scale)`` returns the largest magnitude in the sum of each result: (n, k) to
        (n, m), from the largest magnitude in each feature. Results of a sequence that differ only by rounding are
        made equal. Without `rounding_scale` no result is changed.
    """

    name: str
    description: str
    fit: Callable[..., Any]
    reduce: Callable[[Any, FloatArray], FloatArray]
    rounding_scale: Callable[[Any, FloatArray], FloatArray] | None = None


@dataclass(frozen=True)
class FeatureGroups:
    """Means of groups of features: each column of `weights` (k, m) averages one group, or is zero."""

    weights: FloatArray


def _fit_line(
    touches: FloatArray, settings: Any, generator: np.random.Generator
) -> SelfOrganisingMap:
    return fit_map(touches, line(settings.outputs), settings.training, generator)


def _fit_lattice(
    touches: FloatArray, settings: Any, generator: np.random.Generator
) -> SelfOrganisingMap:
    positions = lattice(settings.outputs, settings.lattice_levels)
    return fit_map(touches, positions, settings.training, generator)


def _fit_groups(
    touches: FloatArray, settings: Any, generator: np.random.Generator
) -> FeatureGroups:
    # The map groups features: each feature is a row of its values at all touches.
    features = touches.T
    fitted = _fit_line(features, settings, generator)
    member = np.eye(len(fitted.weights))[fitted.nearest(features)]
    return FeatureGroups(member / np.maximum(member.sum(axis=0), 1))


def _keep_features(touches: FloatArray, *_: object) -> FeatureGroups:
    return FeatureGroups(np.eye(touches.shape[1]))


def _average(fitted: FeatureGroups, touches: FloatArray) -> FloatArray:
    return touches @ fitted.weights


def _average_scale(fitted: FeatureGroups, scale: FloatArray) -> FloatArray:
    return scale @ abs(fitted.weights)


def _distance_scale(fitted: Any, scale: FloatArray) -> FloatArray:
    return np.linalg.norm(scale, axis=1)[:, None] + np.linalg.norm(fitted.weights, axis=1)


def _one_hot(fitted: Any, touches: FloatArray) -> FloatArray:
    return np.eye(len(fitted.weights))[fitted.nearest(touches)]


MAPS = Registry(
    "map of touches",
    Map(
        "unit_distances", "its distance to each of five units", _fit_line,
        lambda fitted, touches: fitted.distances(touches), rounding_scale=_distance_scale,
    ),
    Map(
        "one_hot", "1 for the nearest of five units and 0 for the others", _fit_line, _one_hot,
    ),
    Map(
        "lattice", "the nearest unit's place on a lattice of five axes", _fit_lattice,
        lambda fitted, touches: fitted.positions[fitted.nearest(touches)],
    ),
    Map(
        "feature_groups", "the means of five groups of features, found by a map over the features",
        _fit_groups, _average, rounding_scale=_average_scale,
    ),
    Map(
        "none", "there is no map, and a touch keeps all its features", _keep_features, _average,
        rounding_scale=_average_scale,
    ),
)  # fmt: skip
