"""Compare the pipelines, and ways of touching, by the kept accuracies of objects."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from classifier_settings.half import choosing_objects
from learned.study import FRAMES, LONG, PIPELINES, TOUCHES
from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.intervals import SIGNIFICANCE, PairedComparison, holm
from visuohaptic.evaluation.leads import LEADS, compare_accuracies
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.report.estimates import lead
from visuohaptic.report.leads import Lead
from visuohaptic.studies.keeping import kept_file

FOLDER = Path(__file__).parent
INTERVALS = IntervalParameters()


class ComparedSetting(NamedTuple):
    """What the pipelines are compared in; `views` are classified together."""

    turns: Turns
    frame: Frame
    touches: int
    views: int
    strategy: str


@dataclass(frozen=True)
class Gains:
    """The comparison of `learned` with `order_free` in the settings of one question.

    Attributes
    ----------
    rows : pandas.DataFrame
        Kept rows of the compared objects.
    compared : dict of ComparedSetting to PairedComparison
        `learned` minus `order_free`.
    stands, stands_for_new_classes : dict of ComparedSetting to bool
        Whether the p value for new objects or for new classes, with Holm's correction for all settings, is below
        `SIGNIFICANCE`.
    """

    rows: pd.DataFrame
    compared: dict[ComparedSetting, PairedComparison]
    stands: dict[ComparedSetting, bool]
    stands_for_new_classes: dict[ComparedSetting, bool]

    @classmethod
    def of(cls, rows: pd.DataFrame) -> Gains:
        """Compare the pipelines in pairs over objects.

        Raises `LookupError` if the pipelines have no object in common in a setting.
        """
        found = dict.fromkeys(rows[[*ComparedSetting._fields]].itertuples(index=False, name=None))
        settings = [ComparedSetting(*one) for one in found]
        compared = {
            one: compare(*(accuracies_in(rows, one, name) for name in reversed(PIPELINES)))
            for one in settings
        }
        stands, stands_for_new_classes = (
            dict(zip(compared, [value < SIGNIFICANCE for value in holm(p_values)], strict=True))
            for p_values in (
                [one.p_value for one in compared.values()],
                [one.p_value_new_classes for one in compared.values()],
            )
        )
        return cls(rows, compared, stands, stands_for_new_classes)

    @property
    def objects(self) -> int:
        """The number of objects."""
        return int(self.rows["object"].nunique())

    @property
    def classes(self) -> int:
        """The number of classes."""
        return count_classes(self.rows)

    @property
    def views(self) -> int:
        """The number of views that are classified together."""
        return int(self.rows["views"].max())

    @property
    def most(self) -> int:
        """The most touches per view."""
        return max(one.touches for one in self.compared)

    def by_views(self) -> tuple[Gains, Gains]:
        """Divide the settings by one view and by all views together; the correction stays that for all settings."""
        single, together = (
            {key: one for key, one in self.compared.items() if (key.views == 1) == is_single}
            for is_single in (True, False)
        )
        stands = self.stands, self.stands_for_new_classes
        return (
            Gains(self.rows[self.rows["views"] == 1], single, *stands),
            Gains(self.rows[self.rows["views"] > 1], together, *stands),
        )

    def ahead(self, touches: int) -> tuple[int, int]:
        """Return in how many settings with so many touches `learned` is shown to be ahead, and the number of settings."""
        return self._ahead(touches, self.stands)

    def ahead_for_new_classes(self, touches: int) -> tuple[int, int]:
        """Return in how many of these settings `learned` is shown to be ahead for new classes, and their number."""
        return self._ahead(touches, self.stands_for_new_classes)

    def _ahead(self, touches: int, stands: dict[ComparedSetting, bool]) -> tuple[int, int]:
        own = [one for one in self.compared if one.touches == touches]
        return sum(stands[one] and self.compared[one].difference.mean > 0 for one in own), len(own)

    def range(self) -> tuple[float, float]:
        """Return the smallest and the largest gain by the most touches, as shares."""
        gains = [
            one.difference.mean for key, one in self.compared.items() if key.touches == self.most
        ]
        return min(gains), max(gains)


def count_classes(rows: pd.DataFrame) -> int:
    """Return the number of classes of the objects, ``class/name``, in kept rows."""
    return len({name.split("/")[0] for name in rows["object"]})


def held_out(folder: Path, name: str) -> pd.DataFrame:
    """Return the kept rows of objects that chose nothing."""
    rows = pd.read_parquet(kept_file(folder, name))
    return rows[~rows["object"].isin(choosing_objects())]


def kept_of_all() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the kept rows on set ``all``, and the rows of the objects that set ``benchmark`` does not have.

    Raises `ValueError` if the rows are not of `learned.all_classes`.
    """
    rows = pd.read_parquet(kept_file(FOLDER, "all"))
    if {*zip(rows["touches"], rows["views"], strict=True)} != {(max(TOUCHES), 1)}:
        raise ValueError(
            f"kept_all.parquet has not only one view with {max(TOUCHES)} touches; run `make learned_all`."
        )
    benchmark = pd.read_parquet(kept_file(FOLDER, "benchmark"))["object"]
    return rows, rows[~rows["object"].isin(benchmark)]


def answers_of(rows: pd.DataFrame) -> tuple[Gains, Gains, Gains]:
    """Compare the pipelines by one view, by one view with `LONG` touches, and by all views of an object together.

    Each question has its own correction.
    """
    is_single, is_long = rows["views"] == 1, rows["touches"] == LONG
    single, long, together = (
        Gains.of(rows[part]) for part in (is_single & ~is_long, is_long, ~is_single)
    )
    return single, long, together


def leads_of(rows: pd.DataFrame) -> tuple[Lead, ...]:
    """Return the leads of places over others on upright objects, by frame and pipeline: one view, the most of `TOUCHES`.

    Raises `LookupError` if the places of a lead have no object in common.
    """
    leads = []
    for frame, pipeline, (name, strategies) in product(FRAMES, PIPELINES, LEADS.items()):
        compared = compare(
            *(
                accuracies_in(rows, ComparedSetting("none", frame, max(TOUCHES), 1, one), pipeline)
                for one in strategies
            )
        )
        leads.append(
            Lead(
                name=name,
                pipeline=pipeline,
                turns="none",
                known=frame,
                draws=1,
                objects=compared.objects,
                difference=lead(compared),
            )
        )
    return tuple(leads)


def objects_in_words(compared: Iterable[PairedComparison | Lead]) -> str:
    """Return the number of compared objects; the fewest and the most, such as ``200 to 208``, where numbers differ."""
    counts = {one.objects for one in compared}
    return " to ".join(str(count) for count in sorted({min(counts), max(counts)}))


def accuracies_in(rows: pd.DataFrame, setting: ComparedSetting, pipeline: str) -> ObjectAccuracies:
    """Return the objects' accuracies in a setting."""
    wanted = {**setting._asdict(), "pipeline": pipeline}
    is_wanted = np.logical_and.reduce([rows[name] == value for name, value in wanted.items()])
    chosen = rows[is_wanted].sort_values("object")
    keys = tuple((name.split("/")[0], name.split("/")[1]) for name in chosen["object"])
    return ObjectAccuracies(keys, *chosen[["accuracy", "weight"]].to_numpy(np.float64).T)


def compare(first: ObjectAccuracies, second: ObjectAccuracies) -> PairedComparison:
    """Compare accuracies in pairs over the objects that both have: first minus second.

    Raises `LookupError` if there is no such object.
    """
    compared = compare_accuracies(first, second, INTERVALS)
    if compared is None:
        raise LookupError("The compared accuracies have no object in common.")
    return compared
