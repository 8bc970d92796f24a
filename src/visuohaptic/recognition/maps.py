"""Maps: what is left of a touch's features before they become a sequence, one entry each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from visuohaptic.base.registry import Registry
from visuohaptic.recognition.self_organising_map import (
    SelfOrganisingMap,
    fit_map,
    lattice,
    line,
)

if TYPE_CHECKING:
    import numpy as np

    from visuohaptic.base.arrays import FloatArray


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
        `recognition.self_organising_map` and a random generator; gives what `reduce` takes. A
        model can be saved if that is a `FeatureGroups` or a `SelfOrganisingMap`.
    reduce : callable
        Takes what was fitted and touches, shape (n, k); gives their numbers, shape (n, m).
    sizes : callable, optional
        Takes what was fitted and the sizes, shape (n, k), of what features were computed from;
        gives those of what the numbers were computed from, shape (n, m). Numbers of a sequence
        that differ by rounding beside them are made equal; without it all stay as they are.
    fitted_as : str, optional
        Another map that fits the same, so that it need not be fitted again.
    """

    name: str
    description: str
    fit: Callable[..., Any]
    reduce: Callable[[Any, FloatArray], FloatArray]
    sizes: Callable[[Any, FloatArray], FloatArray] | None = None
    fitted_as: str | None = None


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
    import numpy as np

    # A map orders the features, each described by its value at every touch.
    features = touches.T
    fitted = _fit_line(features, settings, generator)
    member = np.eye(len(fitted.weights))[fitted.nearest(features)]
    return FeatureGroups(member / np.maximum(member.sum(axis=0), 1))


def _keep_features(touches: FloatArray, *_: object) -> FeatureGroups:
    import numpy as np

    return FeatureGroups(np.eye(touches.shape[1]))


def _average(fitted: FeatureGroups, touches: FloatArray) -> FloatArray:
    return touches @ fitted.weights


def _average_sizes(fitted: FeatureGroups, sizes: FloatArray) -> FloatArray:
    return sizes @ abs(fitted.weights)


def _distance_sizes(fitted: Any, sizes: FloatArray) -> FloatArray:
    import numpy as np

    return np.linalg.norm(sizes, axis=1)[:, None] + np.linalg.norm(fitted.weights, axis=1)


def _one_hot(fitted: Any, touches: FloatArray) -> FloatArray:
    import numpy as np

    return np.eye(len(fitted.weights))[fitted.nearest(touches)]


MAPS = Registry(
    "map of touches",
    Map(
        "unit_distances", "its distance to each of five units", _fit_line,
        lambda fitted, touches: fitted.distances(touches), sizes=_distance_sizes,
    ),
    Map(
        "one_hot", "1 for the nearest of five units and 0 for the others", _fit_line, _one_hot,
        fitted_as="unit_distances",
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
