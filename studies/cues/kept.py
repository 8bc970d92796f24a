"""The accuracies by cue of a run, or the kept accuracies by set of objects."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from cues.study import CUES, CueName, Tested
from cues.tables import ACCURACIES
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.intervals import compare_paired, object_interval
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.report.estimates import Estimate, estimate
from visuohaptic.studies.keeping import Source, kept_files, read_result, read_source

FOLDER = Path(__file__).parent


class CueSetting(NamedTuple):
    """A way to measure, for which the accuracies by cue are compared."""

    tested: Tested
    turns: Turns
    frame: Frame
    touches: int
    pipeline: str
    strategy: str


@dataclass(frozen=True)
class MeasuredCues:
    """The accuracies by cue of one set of objects.

    Attributes
    ----------
    table : pyarrow.Table
        Rows of `ACCURACIES`.
    source : Source or None
        Set, commit and date of kept figures; None for figures of the run itself.
    """

    table: pa.Table
    source: Source | None = None

    @cached_property
    def _cells(self) -> dict[tuple[CueSetting, str], dict[tuple[str, str], tuple[float, float]]]:
        cells: dict[tuple[CueSetting, str], dict[tuple[str, str], tuple[float, float]]] = {}
        for row in self.table.to_pylist():
            setting = CueSetting(*(row[name] for name in CueSetting._fields))
            cell = cells.setdefault((setting, row["cues"]), {})
            cell[row["class"], row["object"]] = row["accuracy"], row["weight"]
        return cells

    @property
    def objects(self) -> int:
        """The number of objects."""
        return len({owner for cell in self._cells.values() for owner in cell})

    def settings(self) -> list[CueSetting]:
        """Return the settings that have a figure."""
        return list(dict.fromkeys(setting for setting, _ in self._cells))

    def has(self, setting: CueSetting, *cues: CueName) -> bool:
        """Return whether all cues were measured in a setting."""
        return all((setting, name) in self._cells for name in cues)

    def accuracy(
        self, setting: CueSetting, cues: CueName, intervals: IntervalParameters
    ) -> Estimate:
        """Compute the accuracy by some cues, with its interval over objects. Raises `ReportError` without a figure."""
        values, weights = self._values(setting, cues)[1]
        return estimate(object_interval(values, weights, intervals))

    def difference(
        self, setting: CueSetting, first: CueName, second: CueName, intervals: IntervalParameters
    ) -> Estimate:
        """Compute the accuracy by the first cues minus that by the second, paired over the objects of both.

        Raises `ReportError` if one of them has no figure.
        """
        (owners, one), (others, other) = (self._values(setting, name) for name in (first, second))
        shared = [owner for owner in owners if owner in set(others)]
        mine, theirs = (
            [own.index(owner) for owner in shared] for own in (list(owners), list(others))
        )
        compared = compare_paired(one[0][mine], other[0][theirs], one[1][mine], intervals)
        return estimate(compared.difference)

    def _values(
        self, setting: CueSetting, cues: CueName
    ) -> tuple[tuple[tuple[str, str], ...], FloatArray]:
        """Return the objects, and their accuracies and weights (2, o)."""
        cell = self._cells.get((setting, cues))
        if cell is None:
            raise ReportError(
                f"No accuracy by {CUES[cues]} is measured for {' '.join(map(str, setting))}."
            )
        owners = tuple(sorted(cell))
        return owners, np.array([cell[owner] for owner in owners], dtype=np.float64).T


def read_cues(path: Path) -> MeasuredCues:
    """Read the accuracies by cue that a run of the study wrote. Raises `ReportError` if the file is damaged."""
    return MeasuredCues(read_result(ACCURACIES, path, "cues"))


def kept_cues(folder: Path = FOLDER) -> dict[str, MeasuredCues]:
    """Read the kept accuracies by cue, by set of objects, the smallest set first; errors as in `read_cues`."""
    kept = {
        name: MeasuredCues(read_cues(path).table, read_source(path))
        for name, path in kept_files(folder).items()
    }
    return dict(sorted(kept.items(), key=lambda item: item[1].objects))


def kept_cues_of(name: str) -> MeasuredCues:
    """Return the kept accuracies by cue of a set of objects, or of the largest set if there are none of the set."""
    kept = kept_cues()
    return kept.get(name) or list(kept.values())[-1]
