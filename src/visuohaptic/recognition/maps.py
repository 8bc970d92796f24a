"""Maps: how a touch's features are reduced to a few numbers, one entry per map."""

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
    """A way to reduce a touch to a few numbers.

    Attributes
    ----------
    name : str
        What parameters call it.
    description : str
        What the numbers are.
    fit : callable
        Takes training touches, shape (n, k), float64, the section
        `recognition.self_organising_map` and a random generator; returns the fitted map.
    reduce : callable
        Takes the fitted map and touches, shape (n, k); returns their numbers, shape (n, m).
    sizes : callable, optional
        Takes the fitted map and the sizes, shape (n, k), of the numbers from which features were computed;
        returns the sizes of the numbers from which the results are computed, shape (n, m). Results of a
        sequence that differ by rounding of these sizes are made equal. Without `sizes` no result changes.
    """

    name: str
    description: str
    fit: Callable[..., Any]
    reduce: Callable[[Any, FloatArray], FloatArray]
    sizes: Callable[[Any, FloatArray], FloatArray] | None = None


@dataclass(frozen=True)
class FeatureGroups:
    """Weighted sums of features: a column of `weights` (k, m) averages a group, or is zero."""

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
    # A map orders the features, each described by its value at every touch.
    features = touches.T
    fitted = _fit_line(features, settings, generator)
    member = np.eye(len(fitted.weights))[fitted.nearest(features)]
    return FeatureGroups(member / np.maximum(member.sum(axis=0), 1))


def _keep_features(touches: FloatArray, *_: object) -> FeatureGroups:
    return FeatureGroups(np.eye(touches.shape[1]))


def _average(fitted: FeatureGroups, touches: FloatArray) -> FloatArray:
    return touches @ fitted.weights


def _average_sizes(fitted: FeatureGroups, sizes: FloatArray) -> FloatArray:
    return sizes @ abs(fitted.weights)


def _distance_sizes(fitted: Any, sizes: FloatArray) -> FloatArray:
    return np.linalg.norm(sizes, axis=1)[:, None] + np.linalg.norm(fitted.weights, axis=1)


def _one_hot(fitted: Any, touches: FloatArray) -> FloatArray:
    return np.eye(len(fitted.weights))[fitted.nearest(touches)]


MAPS = Registry(
    "map of touches",
    Map(
        "unit_distances", "its distance to each of five units", _fit_line,
        lambda fitted, touches: fitted.distances(touches), sizes=_distance_sizes,
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
        _fit_groups, _average, sizes=_average_sizes,
    ),
    Map(
        "none", "there is no map, and a touch keeps all its features", _keep_features, _average,
        sizes=_average_sizes,
    ),
)  # fmt: skip
