"""What differs between runs: parameters, code, packages, processor, seconds and accuracies."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.resources import files as package_files
from string import ascii_uppercase
from typing import Any, Literal

import numpy as np
from markupsafe import Markup

from visuohaptic.errors import ParameterError, ReportError
from visuohaptic.parameters import ExperimentParameters, leaves
from visuohaptic.report.comparison import pipeline_order
from visuohaptic.report.estimates import Figure, points_above_interval
from visuohaptic.report.measured_runs import MEASURES, Cell, CellFigures, MeasuredRun
from visuohaptic.report.wording import classifier_name, counted, strategy_name

Direction = Literal["equal", "higher", "lower", "open"]

EQUAL = Figure(0.0, 0.0, 0.0)
"""The difference of two runs that agree on every object."""

UNKNOWN = "not known"


@dataclass(frozen=True)
class Difference:
    """A run's figure less that of the first run; the p value is of the sign-change test over the same objects."""

    difference: Figure
    p_value: float | None = None

    @property
    def direction(self) -> Direction:
        """`equal` on every object, `higher` or `lower` where the interval leaves out 0, else `open`."""
        found = self.difference
        if found == EQUAL:
            return "equal"
        if found.low is None or found.high is None:
            return "open"
        return "higher" if found.low > 0 else "lower" if found.high < 0 else "open"


@dataclass(frozen=True)
class ComparedFigure:
    """One figure of all runs, and the `differences` of each but the first from it; None where it is missing."""

    measure: str
    pipeline: str
    strategy: str
    classifier: str
    figures: tuple[Figure | None, ...]
    differences: tuple[Difference | None, ...]


@dataclass(frozen=True)
class Fact:
    """Something that is not the same in all runs, such as a parameter: its name, and a text a run."""

    kind: str
    name: str
    texts: tuple[str, ...]


@dataclass(frozen=True)
class RunComparison:
    """Everything that differs, or could have: of each run its letter and where it was read from.

    `facts` are parameters, code, packages and machine that differ, and seconds; `parameters_known`
    says whether each run has parameters of its own.
    """

    labels: tuple[str, ...]
    sources: tuple[str, ...]
    parameters_known: bool
    facts: tuple[Fact, ...]
    figures: tuple[ComparedFigure, ...]

    @property
    def verdicts(self) -> list[str]:
        """How each run differs from the first, a sentence each."""
        return [self._verdict(place) for place in range(len(self.labels) - 1)]

    def _verdict(self, place: int) -> str:
        changed = [fact for fact in self.facts if fact.texts[place + 1] != fact.texts[0]]
        parameters = sum(fact.kind == "parameter" for fact in changed)
        accuracies = [one.differences[place] for one in self.figures if one.measure == MEASURES[0]]
        counts = Counter(one.direction for one in accuracies if one is not None)
        said = (
            "equal on every object"
            if 0 < counts.total() == counts["equal"]
            else f"beyond their intervals {counts['higher']} higher and {counts['lower']} lower, "
            f"equal on every object {counts['equal']}"
        )
        differ = _parameters_differ(parameters) if self.parameters_known else "parameters not known"
        return (
            f"{self.labels[place + 1]} against {self.labels[0]}: {differ}; "
            f"accuracies that both have: {counts.total()}, {said}."
        )

    def as_values(self) -> dict[str, Any]:
        """Give plain values, for machines."""
        values = asdict(self)
        for one, plain in zip(self.figures, values["figures"], strict=True):
            for found, written in zip(one.differences, plain["differences"], strict=True):
                if found is not None:
                    written["direction"] = found.direction
        return values


def _parameters_differ(count: int) -> str:
    if count == 0:
        return "no parameter differs"
    return f"{counted(count, 'parameter')} {'differs' if count == 1 else 'differ'}"


def compare_runs(runs: Sequence[MeasuredRun]) -> RunComparison:
    """Set runs side by side; differences are each run's figure minus the first's.

    Raises `ReportError` for fewer than two runs, or more than there are letters.
    """
    if not 2 <= len(runs) <= len(ascii_uppercase):
        raise ReportError(
            f"{counted(len(runs), 'run')} can't be compared; 2 to {len(ascii_uppercase)} are allowed."
        )
    described = {(run.parameters_source, run.source) for run in runs}
    # One file can't describe two runs.
    known = len({source for source, _ in described}) == len(described) and all(
        run.parameters is not None for run in runs
    )
    cells = dict.fromkeys(cell for run in runs for cell in run.cells)
    compared = [_compared(measure, cell, runs) for measure in MEASURES for cell in cells]
    return RunComparison(
        tuple(ascii_uppercase[: len(runs)]),
        tuple(run.source for run in runs),
        known,
        (*(_parameters(runs) if known else ()), *_circumstances(runs), *_seconds(runs)),
        tuple(one for one in compared if any(one.figures)),
    )


def accuracies(
    comparison: RunComparison,
) -> list[tuple[str, list[str], dict[str, Sequence[Figure | None]]]]:
    """Give each pipeline, what its accuracies are of, and those of each run by its label."""
    shown = [one for one in comparison.figures if one.measure == MEASURES[0]]
    found: list[tuple[str, list[str], dict[str, Sequence[Figure | None]]]] = []
    for pipeline in sorted({one.pipeline for one in shown}, key=pipeline_order):
        own = [one for one in shown if one.pipeline == pipeline]
        names = [f"{classifier_name(one.classifier)}, {strategy_name(one.strategy)}" for one in own]
        sides = zip(*(one.figures for one in own), strict=True)
        found.append((pipeline, names, dict(zip(comparison.labels, sides, strict=True))))
    return found


def difference_in_words(found: Difference) -> str | Markup:
    """Write a difference for its cell: what it is, and whether it is beyond its interval."""
    if found.direction == "equal":
        return "equal on every object"
    said = "within the interval" if found.direction == "open" else found.direction
    p_value = "" if found.p_value is None else f", p {found.p_value:.2g}"
    mean = points_above_interval(found.difference)
    return mean + Markup('<span class="interval {}">{}{}</span>').format(
        found.direction, said, p_value
    )


def render_comparison(comparison: RunComparison) -> str:
    """Give the page of a comparison: HTML that asks the network for nothing."""
    from visuohaptic.report.page import make_environment

    environment = make_environment()
    environment.filters["difference"] = difference_in_words
    style = package_files("visuohaptic.report").joinpath("templates", "style.css")
    return environment.get_template("run_comparison.html.jinja").render(
        comparison=comparison,
        accuracies=accuracies(comparison),
        style=style.read_text("utf-8"),
    )


def difference_of(first: Figure, second: Figure) -> Figure:
    """Give second minus first, with an interval from theirs.

    The method of variance estimates recovery (G. Y. Zou, A. Donner, Statist. Med. 27:1693-1702,
    2008) for independent estimates, as of runs over other objects.
    """
    mean = second.mean - first.mean
    ends = (first.low, first.high, second.low, second.high)
    if None in ends:
        return Figure(mean, None, None)
    low_1, high_1, low_2, high_2 = (float(end) for end in ends if end is not None)
    return Figure(
        mean,
        mean - math.hypot(second.mean - low_2, high_1 - first.mean),
        mean + math.hypot(high_2 - second.mean, first.mean - low_1),
    )


def _paired_difference(first: CellFigures, second: CellFigures) -> Difference:
    """Give second minus first over the same objects, with its interval and p value."""
    from visuohaptic.recognition.intervals import compare_paired
    from visuohaptic.recognition.parameters import IntervalParameters
    from visuohaptic.seeds import spawn_generator

    names = sorted(first.by_object)
    before, weights = np.array([first.by_object[name] for name in names]).T
    after = np.array([second.by_object[name][0] for name in names])
    if np.array_equal(before, after):
        return Difference(EQUAL, 1.0)
    generator = spawn_generator(0, "compared runs")
    found = compare_paired(after, before, weights, IntervalParameters(), generator)
    ends = found.difference
    return Difference(Figure(ends.mean, ends.low, ends.high), found.p_value)


def _compared(measure: str, cell: Cell, runs: Sequence[MeasuredRun]) -> ComparedFigure:
    found = tuple(run.figure(measure, cell) for run in runs)
    differences = tuple(_difference(measure, cell, runs[0], run) for run in runs[1:])
    return ComparedFigure(measure, *cell, found, differences)


def _difference(
    measure: str, cell: Cell, first: MeasuredRun, second: MeasuredRun
) -> Difference | None:
    before, after = (run.figure(measure, cell) for run in (first, second))
    if before is None or after is None:
        return None
    sides = first.cells[cell], second.cells[cell]
    objects, others = (set(side.by_object) for side in sides)
    if measure != MEASURES[0] or not objects or objects != others:
        return Difference(difference_of(before, after))
    return _paired_difference(*sides)


def _parameters(runs: Sequence[MeasuredRun]) -> list[Fact]:
    written = [run.parameters or {} for run in runs]
    whole = [values for values in map(_completed, written) if values is not None]
    # A name that today's workflow lacks can't be completed; then each run is taken as written.
    sides = [dict(leaves(values)) for values in (whole if len(whole) == len(runs) else written)]
    texts = [
        {name: json.dumps(value, ensure_ascii=False, default=str) for name, value in side.items()}
        for side in sides
    ]
    return _differing("parameter", texts, "not named")


def _completed(values: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """Add the defaults of what a file leaves out: it is what was run."""
    try:
        return ExperimentParameters.from_mapping(values).model_dump(mode="json")
    except ParameterError:
        return None


def _circumstances(runs: Sequence[MeasuredRun]) -> list[Fact]:
    """Give the code, the packages and the machine, as far as reports say them."""
    archives = [run.archive for run in runs]
    return [
        *_differing("code", [{"commit": one.commit} if one else {} for one in archives]),
        *_differing("package", [one.versions if one else {} for one in archives]),
        *_differing("machine", [one.machine if one else {} for one in archives]),
    ]


def _differing(kind: str, sides: Sequence[Mapping[str, str]], missing: str = UNKNOWN) -> list[Fact]:
    return [fact for fact in _facts(kind, sides, missing) if len(set(fact.texts)) > 1]


def _facts(kind: str, sides: Sequence[Mapping[str, str]], missing: str = UNKNOWN) -> list[Fact]:
    names = dict.fromkeys(name for side in sides for name in side)
    return [Fact(kind, name, tuple(side.get(name, missing) for side in sides)) for name in names]


def _seconds(runs: Sequence[MeasuredRun]) -> list[Fact]:
    """Give each phase's seconds of imports and work, summed over its jobs, whether they differ or not."""
    phases = [run.archive.seconds if run.archive else () for run in runs]
    sides = [{one.phase: f"{one.imports + one.work:.1f}" for one in side} for side in phases]
    return _facts("seconds", sides)
