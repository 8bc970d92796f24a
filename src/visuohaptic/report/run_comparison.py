"""What differs between runs: parameters, code, packages, processor, seconds and accuracies."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files as package_files
from string import ascii_uppercase
from typing import Literal

import numpy as np
from markupsafe import Markup

from visuohaptic.errors import ParameterError, ReportError
from visuohaptic.parameters import ExperimentParameters, leaves
from visuohaptic.report.comparison import pipeline_order
from visuohaptic.report.estimates import Figure, estimate, points_above_interval
from visuohaptic.report.measured_runs import MEASURES, Cell, CellFigures, MeasuredRun
from visuohaptic.report.page import make_environment
from visuohaptic.report.wording import classifier_name, counted, strategy_name

EQUAL = Figure(0.0, 0.0, 0.0)
"""The difference of two runs that agree on every object."""


@dataclass(frozen=True)
class Difference:
    """A run's figure less that of the first run; p is of the sign-change test over the same objects.

    `equal` is on every object, `higher` or `lower` where the interval leaves out 0, else it is `open`.
    """

    difference: Figure
    p_value: float | None
    direction: Literal["equal", "higher", "lower", "open"]


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

    Seconds are among the `facts` whether they differ or not.
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
        changed = sum(
            fact.kind == "parameter" and fact.texts[place + 1] != fact.texts[0]
            for fact in self.facts
        )
        differ = f"{counted(changed, 'parameter') if changed else 'no parameter'} differ{'s' if changed < 2 else ''}"
        accuracies = [one.differences[place] for one in self.figures if one.measure == MEASURES[0]]
        counts = Counter(one.direction for one in accuracies if one is not None)
        said = (
            "equal on every object"
            if 0 < counts.total() == counts["equal"]
            else f"beyond their intervals {counts['higher']} higher and {counts['lower']} lower, "
            f"equal on every object {counts['equal']}"
        )
        return (
            f"{self.labels[place + 1]} against {self.labels[0]}: "
            f"{differ if self.parameters_known else 'parameters not known'}; "
            f"accuracies that both have: {counts.total()}, {said}."
        )


def compare_runs(runs: Sequence[MeasuredRun]) -> RunComparison:
    """Set 2 to 26 runs side by side; differences are each run's figure minus the first's."""
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
        (*(_parameters(runs) if known else ()), *_circumstances(runs)),
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
    if first.low is None or first.high is None or second.low is None or second.high is None:
        return Figure(mean)
    return Figure(
        mean,
        mean - math.hypot(second.mean - second.low, first.high - first.mean),
        mean + math.hypot(second.high - second.mean, first.mean - first.low),
    )


def _compared(measure: str, cell: Cell, runs: Sequence[MeasuredRun]) -> ComparedFigure:
    sides = [run.cells.get(cell) for run in runs]
    figures = tuple(getattr(side, measure, None) for side in sides)
    differences = tuple(_difference(measure, sides[0], side) for side in sides[1:])
    return ComparedFigure(measure, *cell, figures, differences)


def _difference(
    measure: str, first: CellFigures | None, second: CellFigures | None
) -> Difference | None:
    if first is None or second is None:
        return None
    before, after = getattr(first, measure), getattr(second, measure)
    if before is None or after is None:
        return None
    p_value = None
    if measure == MEASURES[0] and first.by_object and {*first.by_object} == {*second.by_object}:
        found, p_value = _paired_difference(first, second)
    else:
        found = difference_of(before, after)
    if found == EQUAL:
        return Difference(found, p_value, "equal")
    if found.low is not None and found.low > 0:
        return Difference(found, p_value, "higher")
    is_lower = found.high is not None and found.high < 0
    return Difference(found, p_value, "lower" if is_lower else "open")


def _paired_difference(first: CellFigures, second: CellFigures) -> tuple[Figure, float]:
    """Give second minus first over the same objects, with its interval and p value."""
    from visuohaptic.recognition.intervals import compare_paired
    from visuohaptic.recognition.parameters import IntervalParameters
    from visuohaptic.seeds import spawn_generator

    names = sorted(first.by_object)
    before, weights = np.array([first.by_object[name] for name in names]).T
    after = np.array([second.by_object[name][0] for name in names])
    if np.array_equal(before, after):
        return EQUAL, 1.0
    generator = spawn_generator(0, "compared runs")
    found = compare_paired(after, before, weights, IntervalParameters(), generator)
    return estimate(found.difference), found.p_value


def _parameters(runs: Sequence[MeasuredRun]) -> list[Fact]:
    written = [run.parameters or {} for run in runs]
    try:
        # What a file leaves out has its default: it is what was run.
        whole = [ExperimentParameters.from_mapping(one).model_dump(mode="json") for one in written]
    except ParameterError:
        # A name that today's workflow lacks can't be completed; then each run is taken as written.
        whole = [dict(one) for one in written]
    texts = [
        {
            name: json.dumps(value, ensure_ascii=False, default=str)
            for name, value in dict(leaves(values)).items()
        }
        for values in whole
    ]
    return _facts("parameter", texts, "not named")


def _circumstances(runs: Sequence[MeasuredRun]) -> list[Fact]:
    """Give code, packages and machine that differ, and each phase's seconds, as far as reports say them."""
    archives = [run.archive for run in runs]
    seconds = [
        {phase.phase: f"{phase.imports + phase.work:.1f}" for phase in one.seconds} if one else {}
        for one in archives
    ]
    return [
        *_facts("code", [{"commit": one.commit} if one else {} for one in archives]),
        *_facts("package", [one.versions if one else {} for one in archives]),
        *_facts("machine", [one.machine if one else {} for one in archives]),
        *_facts("seconds", seconds, differing=False),
    ]


def _facts(
    kind: str,
    sides: Sequence[Mapping[str, str]],
    missing: str = "not known",
    *,
    differing: bool = True,
) -> list[Fact]:
    """Set texts side by side, a name a fact: all, or those that differ."""
    names = dict.fromkeys(name for side in sides for name in side)
    facts = [Fact(kind, name, tuple(side.get(name, missing) for side in sides)) for name in names]
    return [fact for fact in facts if not differing or len(set(fact.texts)) > 1]
