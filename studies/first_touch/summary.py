"""Accuracies and leads of study `first_touch` from its kept tables."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.intervals import PairedComparison
from visuohaptic.evaluation.leads import compare_accuracies
from visuohaptic.evaluation.means_over_draws import mean_over_draws
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.studies.keeping import kept_file, read_source

LABELS = {
    "human": "where people are predicted to look",
    "fixation": "fixations",
    "curvature": "the most curved places",
    "random": "random places in reach",
    "random_visible": "random places in sight",
    "highest": "the highest visible places",
    "nearest": "the visible places nearest to the eye",
    "central": "the visible places nearest to the line of sight",
    "gaze_channels": "predicted gaze: channels of saliency only",
    "gaze_view": "predicted gaze: view only",
    "gaze_place": "predicted gaze: place on the object only",
    "gaze_shape": "predicted gaze: shape only",
    "gaze_facing": "predicted gaze: surface that faces the eye only",
    "gaze_height": "predicted gaze: height only",
    "gaze_front": "predicted gaze: front and sides only",
    "gaze_extremity": "predicted gaze: distance from the middle only",
    "gaze_without_channels": "predicted gaze without channels of saliency",
    "gaze_without_place": "predicted gaze without place on the object",
    "gaze_without_view": "predicted gaze without view",
    "gaze_without_shape": "predicted gaze without shape",
}
"""The strategies of the study in words, in the order of the page."""


@dataclass(frozen=True)
class Place:
    """A setting of the study: cells of one setting differ in strategy and draws only."""

    pipeline: str = "order_free"
    touches: int = 1
    turns: Turns = "none"
    known: Frame = "full"
    looking: str = "default"


def read_kept(name: str, folder: Path = Path(__file__).parent) -> pd.DataFrame:
    """Read the kept rows of a set of objects, upright and turned.

    Attribute ``date`` is the day of the measurement of upright objects.
    """
    path = kept_file(folder, name)
    turned = kept_file(folder.with_name("first_touch_turned"), name)
    rows = pd.concat([pd.read_parquet(path), pd.read_parquet(turned)], ignore_index=True)
    rows.attrs["date"] = read_source(path).date
    return rows


def accuracies(rows: pd.DataFrame, strategy: str, place: Place) -> ObjectAccuracies:
    """Return the objects' accuracies by a strategy, means over the draws of turns and places.

    Raises `LookupError` if the table has no such row.
    """
    chosen = rows[(rows[list(vars(place))] == pd.Series(vars(place))).all(axis=1)]
    chosen = chosen[chosen["strategy"] == strategy]
    if not len(chosen):
        raise LookupError(f"{strategy} was not measured in {place}.")
    draws = []
    for _, draw in chosen.sort_values("object").groupby(["draw", "places"]):
        names = [name.partition("/") for name in draw["object"]]
        keys = tuple((category, name) for category, _, name in names)
        draws.append(ObjectAccuracies(keys, *draw[["accuracy", "weight"]].to_numpy(np.float64).T))
    return mean_over_draws(draws)


def lead(
    rows: pd.DataFrame, first: str, second: str, place: Place, intervals: IntervalParameters
) -> PairedComparison:
    """Compare two strategies in a setting, in pairs over objects: first minus second."""
    compared = compare_accuracies(
        accuracies(rows, first, place), accuracies(rows, second, place), intervals
    )
    if compared is None:
        raise LookupError(f"{first} and {second} have no object in common in {place}.")
    return compared
