"""How well a prediction agrees with where people looked, on points of a surface.

Measures of Bylinskii et al. 2019, "What do different evaluation metrics tell us about saliency models?",
IEEE TPAMI 41(3), with a point's share of the surface in place of a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from human_gaze.recordings import GazeError
from visuohaptic.base.arrays import BoolArray, FloatArray

TOP_SHARE = 0.2
"""Share of the surface that counts as looked at in `area_under_curve_of_top`."""

# Keeps the logarithm of an empty place finite, as in the reference code of the MIT benchmark.
SMALLEST_SHARE = 2.2204e-16


@dataclass(frozen=True)
class GazedSurface:
    """Points of a surface, shape (n,): time per area that people looked at each, its area, whether it is seen.

    Raises `GazeError` if shapes differ, a value is negative or not finite, or no time or area is seen.
    """

    density: FloatArray
    area: FloatArray
    seen: BoolArray

    def __post_init__(self) -> None:
        if not self.density.shape == self.area.shape == self.seen.shape or self.seen.ndim != 1:
            raise GazeError(
                f"density, area and seen have shapes {self.density.shape}, {self.area.shape} and "
                f"{self.seen.shape}; one (n,) is allowed."
            )
        for name, values in (("density", self.density), ("area", self.area)):
            if not (np.isfinite(values).all() and (values >= 0).all()):
                raise GazeError(f"{name} has values that are negative or not finite.")
        if not (self.density * self.area)[self.seen].sum() > 0:
            raise GazeError("no seen point was looked at; at least one is needed.")

    def weights(self) -> FloatArray:
        """Share of the seen area at each seen point, shape (k,)."""
        area = self.area[self.seen]
        return area / area.sum()

    def shares(self) -> FloatArray:
        """Share of the seen time at each seen point, shape (k,)."""
        time = (self.density * self.area)[self.seen]
        return time / time.sum()

    def of_seen(self, predicted: NDArray[np.floating]) -> FloatArray:
        """Give the prediction at the seen points; `GazeError` if it does not fit them."""
        if predicted.shape != self.density.shape or not np.isfinite(predicted).all():
            raise GazeError(
                f"the prediction has shape {predicted.shape}; {self.density.shape} of finite "
                "numbers is allowed."
            )
        return predicted[self.seen].astype(np.float64)


def correlation(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Give Pearson's correlation over the seen area (CC), -1 to 1; 0 for a constant prediction."""
    weights, values = gazed.weights(), gazed.of_seen(predicted)
    density = gazed.density[gazed.seen]
    values = values - weights @ values
    density = density - weights @ density
    scale = np.sqrt((weights @ values**2) * (weights @ density**2))
    return float(weights @ (values * density) / scale) if scale > 0 else 0.0


def area_under_curve_of_top(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Give the probability that a place of the most looked at fifth, by area, is above one of the rest."""
    weights, density = gazed.weights(), gazed.density[gazed.seen]
    order = np.argsort(-density, kind="stable")
    top = np.zeros(len(order), dtype=bool)
    top[order[: max(1, np.searchsorted(np.cumsum(weights[order]), TOP_SHARE, side="right"))]] = True
    return _probability_above(gazed.of_seen(predicted), weights * top, weights * ~top)


def area_under_curve_of_gaze(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Give the probability that a place drawn by time is above one drawn by area (AUC-Judd)."""
    return _probability_above(gazed.of_seen(predicted), gazed.shares(), gazed.weights())


def normalised_saliency(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Give the mean prediction where people looked, in deviations above its mean (NSS); chance is 0."""
    weights, values = gazed.weights(), gazed.of_seen(predicted)
    values = values - weights @ values
    deviation = np.sqrt(weights @ values**2)
    return float(gazed.shares() @ values / deviation) if deviation > 0 else 0.0


def divergence(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Give the Kullback-Leibler divergence of people's time from the prediction (KL, nats); 0 is best."""
    expected, shares = _predicted_shares(predicted, gazed), gazed.shares()
    return float(np.sum(shares * np.log(SMALLEST_SHARE + shares / (expected + SMALLEST_SHARE))))


def similarity(predicted: NDArray[np.floating], gazed: GazedSurface) -> float:
    """Give the time that prediction and people share (SIM), 0 to 1."""
    return float(np.minimum(_predicted_shares(predicted, gazed), gazed.shares()).sum())


def _predicted_shares(predicted: NDArray[np.floating], gazed: GazedSurface) -> FloatArray:
    values = gazed.of_seen(predicted)
    shifted = (values - min(0.0, float(values.min()))) * gazed.weights()
    return shifted / shifted.sum() if shifted.sum() > 0 else gazed.weights()


def _probability_above(values: FloatArray, upper: FloatArray, lower: FloatArray) -> float:
    """Give the probability that a value drawn by `upper` exceeds one drawn by `lower`."""
    _, place = np.unique(values, return_inverse=True)
    above = np.bincount(place, upper)
    below = np.bincount(place, lower)
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
"""Every measure by its name in tables."""
