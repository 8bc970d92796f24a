"""The kept accuracies of turned objects, by set of objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa

from turned.study import STATISTICS, TRAINED_UPRIGHT, Known
from turned.tables import TURNED
from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.geometry.turning import Turns
from visuohaptic.report.leads import KNOWN as KNOWN_FRAMES
from visuohaptic.studies.figures import rows_by
from visuohaptic.studies.keeping import Source, kept_files, read_result, read_source

FOLDER = Path(__file__).parent

KNOWN: Mapping[Known, str] = dict(
    [
        *KNOWN_FRAMES.items(),
        (STATISTICS, "nothing, without waves"),
        (TRAINED_UPRIGHT, "all is assumed, fitted on upright objects"),
    ]
)
"""The known part of the frame, in words."""

HEADLINE_TOUCHES = 5
"""Touches per sequence in the table beside the headline."""

_CELL = ("turns", "known", "touches", "pipeline", "strategy", "classifier", "draws")


@dataclass(frozen=True)
class TurnedCell:
    """Accuracies and weights of o objects, (o,), means over draws of the turns; NaN for objects that were not tested."""

    turns: Turns
    known: Known
    touches: int
    pipeline: str
    strategy: str
    classifier: str
    draws: int
    accuracy: FloatArray
    weights: FloatArray


@dataclass(frozen=True)
class TurnedSet:
    """The accuracies of one set of objects.

    Attributes
    ----------
    source : Source
        The set, the commit and the date of the measurement.
    objects : tuple of (str, str)
        Class and name of o objects.
    held_out : ndarray of shape (o,), bool
        Whether an object took no part in choosing descriptors and settings.
    cells : sequence of TurnedCell
        The accuracies.
    """

    source: Source
    objects: tuple[tuple[str, str], ...]
    held_out: BoolArray
    cells: Sequence[TurnedCell]

    @property
    def classes(self) -> tuple[str, ...]:
        """The class of each object."""
        return tuple(category for category, _ in self.objects)


def read_turned(folder: Path = FOLDER) -> dict[str, TurnedSet]:
    """Read the kept accuracies in a folder, by set of objects. Raises `ReportError` if a file is damaged."""
    return {
        name: turned_set(read_result(TURNED, path, "turned"), read_source(path))
        for name, path in kept_files(folder).items()
    }


def turned_set(table: pa.Table, source: Source) -> TurnedSet:
    """Return the accuracies in rows of `TURNED`; objects are sorted by class and name."""
    owners = zip(*(table[name].to_pylist() for name in ("class", "object")), strict=True)
    held_out = dict(zip(owners, table["held_out"].to_pylist(), strict=True))
    objects = tuple(sorted(held_out))
    index = {owner: place for place, owner in enumerate(objects)}
    cells = []
    for names, rows in rows_by(table, _CELL).items():
        numbers = np.full((2, len(objects)), np.nan)
        for row in rows.select(["class", "object", "accuracy", "weight"]).to_pylist():
            numbers[:, index[row["class"], row["object"]]] = row["accuracy"], row["weight"]
        cells.append(TurnedCell(*names, *numbers))
    return TurnedSet(source, objects, np.array([held_out[owner] for owner in objects]), cells)
