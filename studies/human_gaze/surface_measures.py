"""Compute how well a prediction agrees with where people looked, on points of a surface.

The measures are those of Bylinskii et al. 2019, "What do different evaluation metrics tell us about saliency models?",
IEEE TPAMI 41(3). A point with its share of the area replaces a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from human_gaze.recordings import GazeError
from visuohaptic.base.arrays import BoolArray, FloatArray

TOP_SHARE = 0.2
"""Share of the surface that counts as looked at in `area_under_curve_of_top`."""

# Keeps the logarithm of a zero share finite, as in the reference code of the MIT benchmark.
SMALLEST_SHARE = 2.2204e-16


@dataclass(frozen=True)
class GazedSurface:
    """Time and area at points of a surface.

    Attributes
    ----------
    density : ndarray of shape (n,)
        Time per area that people looked at each point.
    area : ndarray of shape (n,)
        Area of each point.
    seen : ndarray of shape (n,), bool
        Whether any view sees each point.

    Raises
    ------
    GazeError
        If shapes differ, a value is negative or not finite, or the seen points have no time.
    """

    density: FloatArray
    area: FloatArray
    seen: BoolArray

    def __post_init__(self) -> None:
        if not self.density.shape == self.area.shape == self.seen.shape or self.seen.ndim != 1:
            raise GazeError(
                f"density, area and seen have shapes {self.density.shape}, {self.area.shape} and "
                f"{self.seen.shape}; one shape (n,) for all is needed."
            )
        for name, values in (("density", self.density), ("area", self.area)):
            if not (np.isfinite(values).all() and (values >= 0).all()):
                raise GazeError(
                    f"{name} has values that are negative or not finite; finite values of at least 0 are needed."
                )
        if not (self.density * self.area)[self.seen].sum() > 0:
            raise GazeError("No seen point was looked at; at least one is needed.")

    def weights(self) -> FloatArray:
        """Return the share of the seen area at each seen point, shape (k,)."""
        area = self.area[self.seen]
        return area / area.sum()

    def shares(self) -> FloatArray:
        """Return the share of the seen time at each seen point, shape (k,)."""
        time = (self.density * self.area)[self.seen]
        return time / time.sum()

    def of_seen(self, predicted: NDArray[np.floating]) -> FloatArray:
        """Return a prediction (n,) at the seen points, shape (k,), float64.

        Raises `GazeError` if the prediction has another shape or values that are not finite.
        """
        if predicted.shape != self.density.shape or not np.isfinite(predicted).all():
            raise GazeError(
                f"The prediction has shape {predicted.shape}; shape {self.density.shape} of finite "
                "numbers is needed."
            )
        return predicted[self.seen].astype(np.float64)


def correlation(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Compute Pearson's correlation over the seen area (CC), -1 to 1; 0 for a constant prediction."""
    weights, values = gazed.weights(), gazed.of_seen(predicted)
    density = gazed.density[gazed.seen]
    values = values - weights @ values
    density = density - weights @ density
    scale = np.sqrt((weights @ values**2) * (weights @ density**2))
    return float(weights @ (values * density) / scale) if scale > 0 else 0.0


def area_under_curve_of_top(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Compute the area under the ROC curve of the fifth of the area with the most time per area against the rest.

    That is the probability that the prediction is higher at a point of this fifth than at another point.
    """
    weights, density = gazed.weights(), gazed.density[gazed.seen]
    order = np.argsort(-density, kind="stable")
    top = np.zeros(len(order), dtype=bool)
    top[order[: max(1, np.searchsorted(np.cumsum(weights[order]), TOP_SHARE, side="right"))]] = True
    return _probability_above(gazed.of_seen(predicted), weights * top, weights * ~top)


def area_under_curve_of_gaze(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Compute the probability that the prediction is higher at a point drawn by time than by area (AUC-Judd)."""
    return _probability_above(gazed.of_seen(predicted), gazed.shares(), gazed.weights())


def normalised_saliency(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Compute the mean prediction weighted by time, in standard deviations above the mean (NSS); chance is 0."""
    weights, values = gazed.weights(), gazed.of_seen(predicted)
    values = values - weights @ values
    deviation = np.sqrt(weights @ values**2)
    return float(gazed.shares() @ values / deviation) if deviation > 0 else 0.0


def divergence(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Compute the Kullback-Leibler divergence of people's time from the prediction (KL, nats); 0 is best."""
    expected, shares = _predicted_shares(predicted, gazed), gazed.shares()
    return float(np.sum(shares * np.log(SMALLEST_SHARE + shares / (expected + SMALLEST_SHARE))))


def similarity(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Compute the share of time that prediction and people have in common (SIM), 0 to 1."""
    return float(np.minimum(_predicted_shares(predicted, gazed), gazed.shares()).sum())


def _predicted_shares(predicted: NDArray[np.floating], gazed: GazedSurface) -> FloatArray:
    values = gazed.of_seen(predicted)
    shifted = (values - min(0.0, float(values.min()))) * gazed.weights()
    return shifted / shifted.sum() if shifted.sum() > 0 else gazed.weights()


def _probability_above(values: FloatArray, upper: FloatArray, lower: FloatArray) -> float:
    """Compute the probability that a value drawn by weights `upper` exceeds a value drawn by weights `lower`."""
    _, rank = np.unique(values, return_inverse=True)
    above = np.bincount(rank, upper)
    below = np.bincount(rank, lower)
    less = np.cumsum(below) - 0.5 * below
    return float(above @ less / (above.sum() * below.sum()))


MEASURES = {
    "correlation": correlation,
    "auc_top": area_under_curve_of_top,
    "auc_gaze": area_under_curve_of_gaze,
    "normalised_saliency": normalised_saliency,
    "divergence": divergence,
    "similarity": similarity,
}
"""All measures by name in tables."""
