"""Accuracy over the number of touches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.intervals import Interval
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.summary import summarise


@dataclass(frozen=True)
class TouchCurve:
    """One classifier's accuracy over the first touches of each sequence.

    Attributes
    ----------
    touches : tuple of int
        Numbers of touches, ascending.
    accuracy : tuple of Interval
        Accuracy with each of them.
    """

    touches: tuple[int, ...]
    accuracy: tuple[Interval, ...]

    @property
    def area(self) -> float:
        """Area under the curve by trapezoids, as a share of what accuracy 1 throughout gives."""
        means = np.array([interval.mean for interval in self.accuracy])
        if len(means) == 1:
            return float(means[0])
        steps = np.diff(self.touches)
        return float(((means[1:] + means[:-1]) / 2) @ steps / steps.sum())

    def touches_needed(self, accuracy: float) -> int | None:
        """Give the fewest touches from which on the mean stays at an accuracy, None if never."""
        return self._stays_at(accuracy, [interval.mean for interval in self.accuracy])

    def touches_needed_interval(self, accuracy: float) -> tuple[int | None, int | None]:
        """Give the fewest and the most touches that the intervals leave open for `touches_needed`.

        From the fewest on the intervals' upper ends stay at the accuracy, from the most on their
        lower ends do: the touches at which a test on the interval's level can't tell the
        accuracy from the one asked for. None if never.
        """
        return (
            self._stays_at(accuracy, [interval.high for interval in self.accuracy]),
            self._stays_at(accuracy, [interval.low for interval in self.accuracy]),
        )

    def _stays_at(self, accuracy: float, values: Sequence[float]) -> int | None:
        below = [place for place, value in enumerate(values) if value < accuracy]
        first = max(below) + 1 if below else 0
        return self.touches[first] if first < len(self.touches) else None


def touch_curves(
    features: pa.Table,
    parameters: RecognitionParameters,
    seed: int,
    pipeline: str,
    touches: Sequence[int],
) -> dict[str, TouchCurve]:
    """Train and test with the first touch alone, the first two, and so on.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES` of one strategy, with as many touches as asked for.
    parameters : RecognitionParameters
        As for `run_pipeline`; its number of touches is not used.
    seed : int
        The experiment's seed; every number of touches has the same splits.
    pipeline : str
        ``paper`` or ``best``.
    touches : sequence of int
        Numbers of touches, ascending.

    Returns
    -------
    dict of str to TouchCurve
        A curve a classifier.

    Raises
    ------
    RecognitionError
        If the numbers do not ascend from 1, or a sequence has fewer touches.
    """
    counts = tuple(touches)
    if not counts or counts[0] < 1 or list(counts) != sorted(set(counts)):
        raise RecognitionError(
            f"Touches {list(counts)} are no curve; ascending numbers from 1 are allowed."
        )
    strategy = features.column("strategy")[0].as_py()
    found: dict[str, list[Interval]] = {}
    for count in counts:
        taken = parameters.model_copy(update={"touches": count})
        tables = run_pipeline(features, taken, seed, pipeline)
        cells = summarise(*tables, parameters.intervals, seed)["results"][pipeline][strategy]
        for classifier, cell in cells.items():
            found.setdefault(classifier, []).append(Interval(**cell["accuracy"]))
    return {name: TouchCurve(counts, tuple(points)) for name, points in found.items()}
