"""Fit channel weights to places that people looked at."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from .arrays import Booleans, Floats, Integers, Plane
from .errors import AttentionError
from .parameters import ChannelWeights
from .registry import CHANNELS


@dataclass(frozen=True)
class Example:
    """One view and the places that people looked at.

    `conspicuity` holds maps (h, w), float32, by channel, as in `Attention.conspicuity` with equal weights;
    one that is missing counts as zero. `places` (k, 2), int64, are rows and columns.
    """

    object_name: str
    conspicuity: dict[str, Plane]
    mask: Booleans
    places: Integers


def fit_weights(
    examples: Sequence[Example], tested: Collection[str], spread: float = 0.03
) -> ChannelWeights:
    """Fit non-negative channel weights, whose mean is 1, to the places that people look at.

    Each example's places become a density on the object, Gaussians of standard deviation `spread` of the
    longer edge, to which the weighted sum of maps is fitted by least squares (Zhao & Koch 2011, "Learning
    a saliency map using fixated locations in natural scenes"). Raises `AttentionError` if an example shows
    one of the `tested` objects, there is none, or no channel predicts the places.
    """
    leaked = sorted({example.object_name for example in examples} & set(tested))
    if leaked:
        raise AttentionError(
            f"examples show the tested objects {', '.join(leaked)}; weights may be fitted on "
            "training objects only."
        )
    if not examples:
        raise AttentionError("there are 0 examples to fit weights to; at least 1 is needed.")
    from scipy.optimize import nnls

    # The normal equations have the same solution, and their size does not grow with the number
    # of pixels.
    gram = np.zeros((len(CHANNELS), len(CHANNELS)))
    moment = np.zeros(len(CHANNELS))
    for example in examples:
        maps = _stacked_maps(example)
        gram += maps @ maps.T
        moment += maps @ _density(example, spread)
    values, vectors = np.linalg.eigh(gram)
    kept = values > 1e-9 * max(float(values.max()), 1e-300)
    root = np.sqrt(values[kept])[:, None] * vectors[:, kept].T
    target = (vectors[:, kept].T @ moment) / np.sqrt(values[kept])
    weights, _ = nnls(root, target)
    if not weights.any():
        raise AttentionError(
            "all fitted weights are 0, as no channel is larger at the places looked at; "
            "more or other examples are needed."
        )
    weights *= len(CHANNELS) / weights.sum()
    return ChannelWeights(**dict(zip(CHANNELS, weights.tolist(), strict=True)))


def _stacked_maps(example: Example) -> Floats:
    nothing = np.zeros(example.mask.shape, dtype=np.float32)
    return np.stack(
        [example.conspicuity.get(name, nothing)[example.mask] for name in CHANNELS]
    ).astype(np.float64)


def _density(example: Example, spread: float) -> Floats:
    points = np.zeros(example.mask.shape)
    np.add.at(points, (example.places[:, 0], example.places[:, 1]), 1.0)
    smooth = cv2.GaussianBlur(
        points, (0, 0), spread * max(points.shape), borderType=cv2.BORDER_CONSTANT
    )
    density = smooth[example.mask]
    return density / max(float(density.max(initial=0.0)), 1e-300)
