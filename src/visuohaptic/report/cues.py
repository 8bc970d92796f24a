"""Accuracies by cue of a touch: position, normal, imprint. Measured once and kept with the package.

`make cues` measures them and writes ``cues_SET.parquet`` beside this file (studies/cues/README.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ReportError, TableError
from visuohaptic.evaluation.intervals import compare_paired, object_interval
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.report.estimates import Figure, estimate, with_interval
from visuohaptic.report.wording import counted, listed, percent, pipeline_name, points
from visuohaptic.tables.phases import CELL_KEYS, OBJECT_KEYS
from visuohaptic.tables.schema import REAL, TEXT, Column, Schema, count, read_table, share

KEPT = "cues_{}.parquet"
"""Name of the kept file of a set of objects."""

Tested = Literal["new", "known"]
"""Test objects: new objects of known classes, or objects that were also trained on, seen from new viewpoints."""

CueName = Literal["position", "normal", "pose", "imprint", "all"]

CUES: Mapping[CueName, str] = {
    "position": "positions only",
    "normal": "normals only",
    "pose": "positions and normals, no imprint",
    "imprint": "imprints only",
    "all": "all",
}
"""The cues of a touch, in words."""

SCHEMA = Schema(
    "cues",
    (
        Column(
            "tested", TEXT, "new objects of known classes, or known objects from new viewpoints"
        ),
        Column("turns", TEXT, "how the objects were turned, as meshes.turns"),
        Column("frame", TEXT, "what is known of the object's pose, as recognition.frame"),
        count("touches", "touches per sequence", 1),
        Column("cues", TEXT, "what is known of a touch"),
        *CELL_KEYS,
        *OBJECT_KEYS,
    ),
    (
        share("accuracy", "share of the object's test sequences that is correctly classified"),
        Column("weight", REAL, "weight of the object in the mean over splits", "", 0),
    ),
)


class Setting(NamedTuple):
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
    name : str
        The set of objects.
    table : pyarrow.Table
        Rows of `SCHEMA`.
    commit, date : str
        State of the code and date (UTC) of the measurement; empty for figures of the run itself.
    """

    name: str
    table: pa.Table
    commit: str = ""
    date: str = ""

    @cached_property
    def _cells(self) -> dict[tuple[Setting, str], dict[tuple[str, str], tuple[float, float]]]:
        cells: dict[tuple[Setting, str], dict[tuple[str, str], tuple[float, float]]] = {}
        for row in self.table.to_pylist():
            setting = Setting(*(row[name] for name in Setting._fields))
            cell = cells.setdefault((setting, row["cues"]), {})
            cell[row["class"], row["object"]] = row["accuracy"], row["weight"]
        return cells

    @property
    def objects(self) -> int:
        """The number of objects."""
        return len({owner for cell in self._cells.values() for owner in cell})

    def settings(self) -> list[Setting]:
        """Return the settings that have a figure."""
        return list(dict.fromkeys(setting for setting, _ in self._cells))

    def has(self, setting: Setting, *cues: CueName) -> bool:
        """Return whether all cues were measured in a setting."""
        return all((setting, name) in self._cells for name in cues)

    def accuracy(self, setting: Setting, cues: CueName, intervals: IntervalParameters) -> Figure:
        """Compute the accuracy by some cues, with its interval over objects. Raises `ReportError` without a figure."""
        values, weights = self._values(setting, cues)[1]
        return estimate(object_interval(values, weights, intervals))

    def difference(
        self, setting: Setting, first: CueName, second: CueName, intervals: IntervalParameters
    ) -> Figure:
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
        self, setting: Setting, cues: CueName
    ) -> tuple[tuple[tuple[str, str], ...], FloatArray]:
        """Return the objects, and their accuracies and weights (2, o)."""
        cell = self._cells.get((setting, cues))
        if cell is None:
            raise ReportError(
                f"No accuracy by {CUES[cues]} is measured for {' '.join(map(str, setting))}."
            )
        owners = tuple(sorted(cell))
        return owners, np.array([cell[owner] for owner in owners], dtype=np.float64).T


def read_cues(path: Path, name: str) -> MeasuredCues:
    """Read the accuracies by cue of a set of objects.

    Raises `ReportError` if the file is damaged.
    """
    try:
        table = read_table(SCHEMA, path)
        metadata = pq.read_schema(path).metadata or {}
        commit, date = (metadata.get(key, b"").decode("utf-8") for key in (b"commit", b"date"))
    except (TableError, OSError, ValueError) as error:
        raise ReportError(
            f"{path} holds no accuracies by cue ({error}); run `make cues` again."
        ) from error
    return MeasuredCues(name, table, commit, date)


def kept_cues() -> dict[str, MeasuredCues]:
    """Read the accuracies by cue that are kept with the package, by set of objects, the smallest set first."""
    folder = Path(str(files("visuohaptic.report")))
    start, end = KEPT.split("{}")
    kept = {
        path.name.removeprefix(start).removesuffix(end): path
        for path in sorted(folder.glob(KEPT.format("*")))
    }
    measured = [read_cues(path, name) for name, path in kept.items()]
    return {one.name: one for one in sorted(measured, key=lambda one: one.objects)}


def carries_sentence(
    name: str,
    intervals: IntervalParameters,
    own: Path | None = None,
    touches: int = 5,
    strategy: str = "fixation",
) -> str:
    """Return sentences on what carries the accuracy on upright objects: where the sensor is, or what the skin feels.

    Parameters
    ----------
    name : str
        The set of the run's objects.
    intervals : IntervalParameters
        The confidence of the intervals.
    own : Path, optional
        The file ``results/cues.parquet`` of the run. If there is none, the figures are those kept for the set of
        objects, or for the largest kept set; the sentence then names the objects and the date.
    touches : int
        The number of touches per sequence.
    strategy : str
        The strategy of the touches.

    Returns
    -------
    str
        Accuracies of each pipeline by positions and normals, and by imprints; which of the two is ahead; what
        imprints add. A difference has a sign only if its interval excludes 0. A sentence without figures if
        the number of touches or the strategy was not measured.

    Raises
    ------
    ReportError
        If a file is damaged.
    """
    measured = _chosen(name, own)
    upright = _by_pipeline(measured, "new", "none", touches, strategy)
    if not upright:
        return (
            f"What carries the accuracy was not measured for {counted(touches, 'touch')} by strategy {strategy} "
            f"({_named(measured)})."
        )
    pose, imprint = (
        [with_interval(measured.accuracy(one, cue, intervals), percent) for one in upright]
        for cue in _TWO
    )
    names = [pipeline_name(one.pipeline) for one in upright]
    by = listed([f"{one} by {pipeline}" for one, pipeline in zip(pose, names, strict=True)])
    ahead = [measured.difference(one, "pose", "imprint", intervals) for one in upright]
    added = [measured.difference(one, "all", "pose", intervals) for one in upright]
    numbers = (
        f"Positions and normals of {counted(touches, 'touch')}, without any imprint, give {by}; imprints only give "
        f"{listed(imprint)} ({_named(measured)})."
    )
    return " ".join([numbers, _verdicts(names, ahead, _WHICH), _verdicts(names, added, _ADDED)])


def imprints_sentence(name: str, intervals: IntervalParameters, own: Path | None = None) -> str:
    """Return a sentence on the settings in which imprints raise the accuracy of pipeline `order_free`, by fixation.

    Parameters and errors are those of `carries_sentence`. The settings are an unknown pose, a single touch and known
    objects, as far as they are measured. Each gain is that of all cues over positions and normals. Without a pose a
    single touch has only its imprint; its accuracy is given instead of a gain.
    """
    measured = _chosen(name, own)
    found = [
        f"{words}: {_gain(measured, setting, intervals)}"
        for words, setting in _SETTINGS.items()
        if measured.has(setting, "all")
    ]
    return f"What imprints add to positions and normals in pipeline order_free: {'; '.join(found)} ({_named(measured)})."


_TWO: tuple[CueName, CueName] = ("pose", "imprint")

_SETTINGS: Mapping[str, Setting] = {
    "pose known, five touches": Setting("new", "none", "full", 5, "order_free", "fixation"),
    "pose known, one touch": Setting("new", "none", "full", 1, "order_free", "fixation"),
    "nothing known of the pose, five touches": Setting(
        "new", "none", "none", 5, "order_free", "fixation"
    ),
    "nothing known of the pose, one touch": Setting(
        "new", "none", "none", 1, "order_free", "fixation"
    ),
    "objects turned in any way and nothing known of the pose, five touches": Setting(
        "new", "any", "none", 5, "order_free", "fixation"
    ),
    "known objects from new viewpoints, one touch": Setting(
        "known", "none", "full", 1, "order_free", "fixation"
    ),
    "known objects from new viewpoints, nothing known of the pose, five touches": Setting(
        "known", "none", "none", 5, "order_free", "fixation"
    ),
}
"""The settings of `imprints_sentence`."""

_WHICH = (
    "Where the sensor is and how it stands carries more than what the skin feels",
    "What the skin feels carries more than where the sensor is and how it stands",
    "Which of the two carries more is not settled",
)
_ADDED = (
    "Imprints add to positions and normals",
    "Imprints take from what positions and normals give",
    "That imprints add anything to positions and normals is not shown",
)


def _verdicts(names: Sequence[str], differences: Sequence[Figure], words: Sequence[str]) -> str:
    """Return one sentence per sign of the differences that occurs, with the pipelines and their differences."""
    signs = [_sign(one) for one in differences]
    sentences = []
    for sign in dict.fromkeys(signs):
        listed_ = listed(
            [
                f"{with_interval(one, points, ' points')} in {name}"
                for name, one, own in zip(names, differences, signs, strict=True)
                if own == sign
            ]
        )
        sentences.append(f"{words[sign]}: {listed_}.")
    return " ".join(sentences)


def _sign(difference: Figure) -> int:
    """Return 0 if the interval lies above 0, 1 if it lies below 0, and 2 for all others."""
    if difference.low is not None and difference.low > 0:
        return 0
    if difference.high is not None and difference.high < 0:
        return 1
    return 2


def _gain(measured: MeasuredCues, setting: Setting, intervals: IntervalParameters) -> str:
    if not measured.has(setting, "pose"):
        only = with_interval(measured.accuracy(setting, "all", intervals), percent)
        return f"{only}, all of it by the imprint"
    gain = measured.difference(setting, "all", "pose", intervals)
    shown = ("", ", a loss", ", not settled")[_sign(gain)]
    return f"{with_interval(gain, points, ' points')}{shown}"


def _chosen(name: str, own: Path | None) -> MeasuredCues:
    """Return the run's figures, or else the kept figures of its set or of the largest set."""
    if own is not None and own.is_file():
        return read_cues(own, name)
    kept = kept_cues()
    return kept.get(name) or list(kept.values())[-1]


def _by_pipeline(
    measured: MeasuredCues, tested: Tested, turns: Turns, touches: int, strategy: str
) -> list[Setting]:
    """Return the settings with the full frame that have all cues, pipeline `order_free` first."""
    named = (tested, turns, "full", touches)
    return sorted(
        (
            one
            for one in measured.settings()
            if one[:4] == named and one.strategy == strategy and measured.has(one, *CUES)
        ),
        key=lambda one: one.pipeline != "order_free",
    )


def _named(measured: MeasuredCues) -> str:
    """Return the objects of the figures, and for kept figures the date."""
    objects = counted(measured.objects, "object")
    if not measured.date:
        return f"{objects} of this run"
    return f"{objects} of set {measured.name}, measured on {measured.date}"
