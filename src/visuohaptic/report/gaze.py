"""Attention compared with human gaze: means over objects, what is ahead of what, and pictures."""

from __future__ import annotations

import math
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from visuohaptic.gaze.stored import MeasuredGaze
from visuohaptic.gaze.summary import PredictorRow, beside_peer, summarise
from visuohaptic.recognition.intervals import Interval
from visuohaptic.report.wording import counted
from visuohaptic.tables.gaze import GAZE_PICTURES
from visuohaptic.tables.schema import read_table

WORST_NAMED = 6


@dataclass(frozen=True)
class Pictured:
    """One object: its name, the correlation of predictor human, and the picture as a data URL."""

    name: str
    correlation: float
    source: str


@dataclass(frozen=True)
class GazeFigures:
    """What the page shows of gaze.

    Attributes
    ----------
    sentences : tuple of str
        What the table says.
    rows, tests : sequence of PredictorRow
        Objects held out in turn, and those for tests.
    shown : sequence of PredictorRow
        The few of `rows` that the sentences are about.
    peer : sequence of PredictorRow
        Objects that others predicted, with gains over them; empty without such.
    worst : sequence of (str, float)
        Objects with the lowest correlations, lowest first.
    pictures : sequence of Pictured
        The worst, then the best; empty where the run has none.
    largest_error : float
        Largest alignment error, object radii.
    origin : mapping or None
        Where figures come from that are not of this run.
    """

    sentences: tuple[str, ...]
    rows: Sequence[PredictorRow]
    tests: Sequence[PredictorRow]
    shown: Sequence[PredictorRow]
    peer: Sequence[PredictorRow]
    worst: Sequence[tuple[str, float]]
    pictures: Sequence[Pictured]
    largest_error: float
    origin: Mapping[str, str] | None


def gaze_figures(
    measured: MeasuredGaze | None, pictures: str | Path | None = None
) -> GazeFigures | None:
    """Give what the page shows; None where nothing was measured."""
    if measured is None:
        return None
    rows, tests = (summarise(measured.table, part) for part in ("training", "test"))
    if not rows:
        return None
    held = [row for row in measured.table.to_pylist() if row["predictor"] == "human"]
    held.sort(key=lambda row: (row["correlation"], row["object"]))
    return GazeFigures(
        sentences=tuple(_sentences(rows, tests)),
        rows=rows,
        tests=tests,
        shown=shown_predictors(rows),
        peer=beside_peer(measured.table),
        worst=[(row["object"], row["correlation"]) for row in held[:WORST_NAMED]],
        pictures=_pictures(pictures),
        largest_error=max(row["alignment_error"] for row in held),
        origin=measured.origin,
    )


def decimal(value: float) -> str:
    """Give two decimals, with a true minus sign."""
    return f"{value:.2f}".replace("-0.00", "0.00").replace("-", "\u2212")


def between(value: Interval) -> str:
    """Give a mean and its interval, such as ``0.16 (0.12 to 0.20)``; of one object the mean alone."""
    if math.isnan(value.low):
        return decimal(value.mean)
    return f"{decimal(value.mean)} ({decimal(value.low)} to {decimal(value.high)})"


def _sentences(rows: Sequence[PredictorRow], tests: Sequence[PredictorRow]) -> list[str]:
    equal, floor, placed, chosen = shown_predictors(rows)
    place = placed.measures["correlation"]
    found = [
        (
            f"On {equal.objects} objects the saliency map's correlation with the time that people looked at "
            f"each place is {between(equal.measures['correlation'])} with equal weights of its channels; "
            f"{floor.predictor.label}, which needs no model, gives {between(floor.measures['correlation'])}, and "
            f"weights fitted to other objects, with terms such as height, give "
            f"{between(chosen.measures['correlation'])}."
        ),
        (
            f"The fitted weights gain {between(chosen.gain)} over equal ones; the area under the curve for the "
            f"most looked at fifth is {between(chosen.measures['auc_top'])}."
        ),
        (
            f"Place on the object alone, up and to the front, reaches {between(place)}: a large part of what is "
            "gained is knowing where on an object people look, which holds for objects that stand "
            "upright and face the front."
        ),
    ]
    return [
        *found,
        *(
            f"With all fronts turned at random all channels and terms reach "
            f"{between(row.measures['correlation'])}."
            for row in rows
            if row.predictor.name == "human_turned"
        ),
        *(
            f"On {counted(row.objects, 'object')} for tests, looked at once, it reaches "
            f"{between(row.measures['correlation'])} and {between(row.measures['auc_top'])}."
            for row in tests
            if row.predictor.name == "chosen"
        ),
    ]


def shown_predictors(rows: Sequence[PredictorRow]) -> tuple[PredictorRow, ...]:
    """Choose equal weights, the best floor, place alone, and the chosen terms."""
    by_name = {row.predictor.name: row for row in rows}
    floor = max(
        (row for row in rows if row.predictor.kind == "floor"),
        key=lambda row: row.measures["correlation"].mean,
    )
    return by_name["equal"], floor, by_name["place"], by_name["chosen"]


def _pictures(path: str | Path | None) -> list[Pictured]:
    if path is None or not Path(path).is_file():
        return []
    rows = sorted(read_table(GAZE_PICTURES, [path]).to_pylist(), key=lambda row: row["rank"])
    return [
        Pictured(
            row["object"],
            row["correlation"],
            "data:image/png;base64," + b64encode(row["picture"]).decode("ascii"),
        )
        for row in rows
    ]
