"""What changed from one run to another: parameters, accuracies with their intervals, seconds, views."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib.resources import files as package_files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from visuohaptic.errors import ParameterError, ReportError
from visuohaptic.optional_packages import require
from visuohaptic.parameters import ExperimentParameters, leaves
from visuohaptic.report import figures as charts
from visuohaptic.report.archive import Archive, ArchivedView, read_archive
from visuohaptic.report.comparison import Figure, pipeline_order
from visuohaptic.report.objects import FixationMark
from visuohaptic.report.provenance import PhaseSeconds
from visuohaptic.report.wording import classifier_name, strategy_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

ByObject = Mapping[str, tuple[float, float]]

EQUAL = Figure(0.0, 0.0, 0.0)
"""The difference of two runs that agree on every object."""

MEASURES = ("accuracy", "object_accuracy", "balanced_accuracy")
_METRICS = "reports/metrics.json"
_PARAMETERS = "params.yaml"
_REPORT = "report.html"


@dataclass(frozen=True)
class MeasuredRun:
    """One run's figures.

    Attributes
    ----------
    source : str
        Where it was read from.
    parameters : mapping or None
        As in ``params.yaml``; None where unknown.
    parameters_source : str
        Where they were found.
    figures : mapping
        By (measure, pipeline, strategy, classifier).
    archive : Archive or None
        What the run's report carries; None where no report of these figures is at hand.
    by_object : mapping
        By (pipeline, strategy, classifier): each object's accuracy and its weight, by its name.
    """

    source: str
    parameters: Mapping[str, Any] | None
    parameters_source: str
    figures: Mapping[tuple[str, str, str, str], Figure]
    archive: Archive | None = None
    by_object: Mapping[tuple[str, str, str], ByObject] = field(default_factory=dict)


@dataclass(frozen=True)
class ChangedParameter:
    """A parameter that differs; None on a side that does not have it."""

    name: str
    first: str | None
    second: str | None


@dataclass(frozen=True)
class ChangedFigure:
    """One figure of both runs; None on a side that does not have it.

    The p value is that of the sign-change test over the objects that both runs tested; None where they are not
    the same.
    """

    measure: str
    pipeline: str
    strategy: str
    classifier: str
    first: Figure | None
    second: Figure | None
    difference: Figure | None
    p_value: float | None = None

    @property
    def direction(self) -> str:
        """`equal` on every object, `higher` or `lower` where the difference's interval leaves out 0, else `open`."""
        found = self.difference
        if found == EQUAL:
            return "equal"
        if found is None or found.low is None or found.high is None:
            return "open"
        return "higher" if found.low > 0 else "lower" if found.high < 0 else "open"


@dataclass(frozen=True)
class ChangedSeconds:
    """A phase's seconds of imports and work in both runs; None on a side that has no log of it."""

    phase: str
    first: float | None
    second: float | None


@dataclass(frozen=True)
class ComparedView:
    """An object as both runs saw it; None on a side that did not, or carries no picture."""

    key: str
    first: ArchivedView | None
    second: ArchivedView | None


@dataclass(frozen=True)
class RunComparison:
    """Everything that differs, or could have.

    `seconds`, `machines` and `views` are empty where no run's report is at hand.
    """

    first: str
    second: str
    parameters_known: bool
    parameters: tuple[ChangedParameter, ...]
    figures: tuple[ChangedFigure, ...]
    seconds: tuple[ChangedSeconds, ...] = ()
    machines: tuple[str, ...] = ()
    views: tuple[ComparedView, ...] = ()

    @property
    def verdict(self) -> str:
        """How many parameters differ, and how many accuracies are higher or lower."""
        changed = f"parameters that differ: {len(self.parameters)}"
        shared = [
            figure
            for figure in self.figures
            if figure.measure == MEASURES[0] and figure.difference is not None
        ]
        counts = {
            name: sum(figure.direction == name for figure in shared)
            for name in ("higher", "lower", "equal")
        }
        return (
            f"{changed if self.parameters_known else 'parameters not known'}; "
            f"accuracies that both runs have: {len(shared)}; beyond their intervals, higher in the "
            f"second: {counts['higher']}, lower: {counts['lower']}; equal on every object: {counts['equal']}."
        )

    def as_values(self) -> dict[str, Any]:
        """Give plain values, for machines; pictures are left to the page."""
        values = asdict(self)
        values["views"] = [view.key for view in self.views]
        for figure, plain in zip(self.figures, values["figures"], strict=True):
            plain["direction"] = figure.direction
        return values


def read_measured_run(source: str | Path) -> MeasuredRun:
    """Read a run's metrics, and what else of it can be found.

    `source` is a metrics file, or a report; or the folder of a run or of its reports; or a DVC
    experiment or Git revision of the repository around the working folder. Of a metrics file with
    its own report beside it, the report gives parameters, seconds and views; without one, a
    ``params.yaml`` beside the file or one folder above is taken as the run's.

    Raises `ReportError` if there are no metrics, or they are not of this workflow.
    """
    path = Path(source)
    if not path.exists() and not path.suffix:
        return _read_experiment(str(source))
    file = _metrics_file(path)
    try:
        content = file.read_bytes()
    except OSError as error:
        raise ReportError(
            f"{file} can't be read: {error.strerror}; `snakemake -j2` makes a run's metrics."
        ) from error
    if file.suffix == ".html":
        return _of_archive(read_archive(content.decode("utf-8", "replace"), str(file)), str(file))
    metrics = _parsed(content, str(file))
    figures = _figures(metrics, str(file))
    archive = _report_beside(file, figures)
    if archive is not None:
        return _of_archive(archive, str(file))
    found = _find_parameters(file)
    values = None if found is None else _yaml(found.read_bytes(), str(found))
    return MeasuredRun(
        str(file), values, str(found), figures, by_object=_by_object(metrics, str(file))
    )


def compare_runs(first: MeasuredRun, second: MeasuredRun) -> RunComparison:
    """Set two runs side by side; differences are second minus first."""
    # One file can't describe two runs: at most, it belongs to the later one.
    own = first.parameters_source != second.parameters_source or first.source == second.source
    known = own and first.parameters is not None and second.parameters is not None
    keys = dict.fromkeys([*first.figures, *second.figures])
    ordered = sorted(keys, key=lambda key: MEASURES.index(key[0]))
    archives = (first.archive, second.archive)
    return RunComparison(
        first.source,
        second.source,
        known,
        _changed_parameters(first.parameters or {}, second.parameters or {}) if known else (),
        tuple(_changed_figure(key, first, second) for key in ordered),
        _changed_seconds(*archives),
        tuple(_machine(archive) for archive in archives) if any(archives) else (),
        _compared_views(*archives),
    )


def accuracy_charts(comparison: RunComparison) -> list[tuple[str, Drawing]]:
    """Draw the accuracies of both runs, a chart a pipeline."""
    shown = [figure for figure in comparison.figures if figure.measure == MEASURES[0]]
    pipelines = sorted({figure.pipeline for figure in shown}, key=pipeline_order)
    return [
        (pipeline, _chart([figure for figure in shown if figure.pipeline == pipeline]))
        for pipeline in pipelines
    ]


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


def render_comparison(comparison: RunComparison) -> str:
    """Give the page of a comparison: HTML that asks the network for nothing."""
    from visuohaptic.report.page import make_environment

    environment = make_environment()
    style = package_files("visuohaptic.report").joinpath("templates", "style.css")
    return environment.get_template("run_comparison.html.jinja").render(
        comparison=comparison,
        charts=accuracy_charts(comparison),
        marks=max((mark.number for mark in _all_marks(comparison)), default=0),
        measures=MEASURES,
        style=style.read_text("utf-8"),
    )


def _estimate(values: Mapping[str, Any]) -> Figure:
    mean, low, high = float(values["mean"]), values["low"], values["high"]
    return Figure(mean, None if low is None else float(low), None if high is None else float(high))


def _metrics_file(path: Path) -> Path:
    """Find the file of a run that was named by its folder or by the folder of its reports."""
    if not path.is_dir():
        return path
    of_reports = path / Path(_METRICS).name
    return of_reports if of_reports.is_file() else path / _METRICS


def _report_beside(
    file: Path, figures: Mapping[tuple[str, str, str, str], Figure]
) -> Archive | None:
    """Read the report beside a metrics file; None if its figures are those of another run."""
    report = file.parent / _REPORT
    if not report.is_file():
        return None
    return _archive_of(report.read_text("utf-8", "replace"), str(report), figures)


def _archive_of(
    page: str, source: str, figures: Mapping[tuple[str, str, str, str], Figure]
) -> Archive | None:
    try:
        archive = read_archive(page, source)
        return archive if _figures(archive.metrics, source) == figures else None
    except ReportError:
        # The metrics are valid by themselves, even if the report beside them is outdated.
        return None


def _of_archive(archive: Archive, source: str) -> MeasuredRun:
    figures = _figures(archive.metrics, source)
    objects = _by_object(archive.metrics, source)
    return MeasuredRun(source, archive.parameters, f"{source}: report", figures, archive, objects)


def _read_experiment(name: str) -> MeasuredRun:
    require("workflow", "dvc")
    import dvc.api  # type: ignore[import-untyped]
    from dvc.exceptions import DvcException  # type: ignore[import-untyped]

    try:
        metrics, parameters = (
            dvc.api.read(path, rev=name).encode() for path in (_METRICS, _PARAMETERS)
        )
    # DVC and the Git libraries below it raise many types; the cause is a wrong name.
    except (DvcException, OSError, ValueError, KeyError) as error:
        raise ReportError(
            f"{name} is no file, and no experiment of this repository that has {_METRICS} "
            f"({error}); `dvc exp show` lists the experiments."
        ) from error
    parsed = _parsed(metrics, name)
    figures = _figures(parsed, name)
    source = f"{name}:{_PARAMETERS}"
    try:
        page = dvc.api.read(f"reports/{_REPORT}", rev=name)
    except (DvcException, OSError, ValueError, KeyError):
        # Kept by DVC, and perhaps not at hand: seconds and views are left out then.
        page = ""
    archive = _archive_of(page, name, figures)
    values = _yaml(parameters, source)
    return MeasuredRun(name, values, source, figures, archive, _by_object(parsed, name))


def _parsed(content: bytes, source: str) -> Mapping[str, Any]:
    try:
        values = json.loads(content)
    except ValueError as error:
        raise _no_metrics(source) from error
    if not isinstance(values, dict):
        raise _no_metrics(source)
    return values


def _figures(metrics: Mapping[str, Any], source: str) -> dict[tuple[str, str, str, str], Figure]:
    try:
        return {
            (measure, pipeline, strategy, classifier): _estimate(figures[measure])
            for pipeline, strategies in metrics["results"].items()
            for strategy, classifiers in strategies.items()
            for classifier, figures in classifiers.items()
            for measure in MEASURES
            if measure in figures
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise _no_metrics(source) from error


def _by_object(metrics: Mapping[str, Any], source: str) -> dict[tuple[str, str, str], ByObject]:
    """Give objects' accuracies; nothing of metrics of a version that kept none."""
    try:
        return {
            (pipeline, strategy, classifier): {
                name: (float(accuracy), float(weight))
                for name, (accuracy, weight) in figures.get("by_object", {}).items()
            }
            for pipeline, strategies in metrics["results"].items()
            for strategy, classifiers in strategies.items()
            for classifier, figures in classifiers.items()
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise _no_metrics(source) from error


def _no_metrics(source: str) -> ReportError:
    return ReportError(
        f"{source} holds no metrics of this workflow; {_METRICS} of a run is needed."
    )


def _find_parameters(file: Path) -> Path | None:
    folder = file.resolve().parent
    beside = (folder / _PARAMETERS, folder.parent / _PARAMETERS)
    return next((path for path in beside if path.is_file()), None)


def _yaml(text: bytes, source: str) -> dict[str, Any]:
    import yaml

    try:
        values = yaml.safe_load(text)
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise ReportError(f"{source} can't be read as YAML; correct it or delete it.") from error
    return values if isinstance(values, dict) else {}


def _changed_parameters(
    first: Mapping[str, Any], second: Mapping[str, Any]
) -> tuple[ChangedParameter, ...]:
    whole = [_completed(side) for side in (first, second)]
    known = [side for side in whole if side is not None]
    # A name that today's workflow lacks can't be completed; then each side is taken as written.
    sides = [dict(leaves(side)) for side in (known if len(known) == 2 else (first, second))]
    names = dict.fromkeys(name for side in sides for name in side)
    texts = [ChangedParameter(name, *(_text(side, name) for side in sides)) for name in names]
    return tuple(change for change in texts if change.first != change.second)


def _completed(values: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """Add the defaults of what a file leaves out: it is what was run."""
    try:
        return ExperimentParameters.from_mapping(values).model_dump(mode="json")
    except ParameterError:
        return None


def _changed_seconds(first: Archive | None, second: Archive | None) -> tuple[ChangedSeconds, ...]:
    sides = [_seconds_of(archive) for archive in (first, second)]
    phases = dict.fromkeys(phase for side in sides for phase in side)
    return tuple(ChangedSeconds(phase, *(side.get(phase) for side in sides)) for phase in phases)


def _seconds_of(archive: Archive | None) -> dict[str, float]:
    phases: tuple[PhaseSeconds, ...] = () if archive is None else archive.seconds
    return {phase.phase: phase.imports + phase.work for phase in phases}


def _machine(archive: Archive | None) -> str:
    if archive is None:
        return "unknown: no report of this run is at hand"
    return f"{archive.machine.get('Processor', '?')}, {archive.machine.get('Cores', '?')} cores"


def _compared_views(first: Archive | None, second: Archive | None) -> tuple[ComparedView, ...]:
    sides = [{} if archive is None else archive.views for archive in (first, second)]
    keys = sorted({key for side in sides for key in side})
    return tuple(ComparedView(key, *(side.get(key) for side in sides)) for key in keys)


def _all_marks(comparison: RunComparison) -> list[FixationMark]:
    sides = [side for view in comparison.views for side in (view.first, view.second)]
    return [mark for side in sides if side is not None for mark in side.marks]


def _chart(rows: Sequence[ChangedFigure]) -> Drawing:
    names = [f"{classifier_name(row.classifier)}, {strategy_name(row.strategy)}" for row in rows]
    sides = {"A": [row.first for row in rows], "B": [row.second for row in rows]}
    return charts.runs(names, sides)


def _text(side: Mapping[str, Any], name: str) -> str | None:
    return json.dumps(side[name], ensure_ascii=False, default=str) if name in side else None


def _changed_figure(
    key: tuple[str, str, str, str], first: MeasuredRun, second: MeasuredRun
) -> ChangedFigure:
    before, after = first.figures.get(key), second.figures.get(key)
    if before is None or after is None:
        return ChangedFigure(*key, first=before, second=after, difference=None)
    sides = [run.by_object.get(key[1:], {}) for run in (first, second)]
    if key[0] != MEASURES[0] or not sides[0] or set(sides[0]) != set(sides[1]):
        return ChangedFigure(*key, before, after, difference_of(before, after))
    return ChangedFigure(*key, before, after, *paired_difference(*sides))


def paired_difference(first: ByObject, second: ByObject) -> tuple[Figure, float]:
    """Give second minus first over the same objects, with its interval and the p value of the sign-change test."""
    from visuohaptic.recognition.intervals import compare_paired
    from visuohaptic.recognition.parameters import IntervalParameters
    from visuohaptic.seeds import spawn_generator

    names = sorted(first)
    before, weights = np.array([first[name] for name in names]).T
    after = np.array([second[name][0] for name in names])
    if np.array_equal(before, after):
        return EQUAL, 1.0
    generator = spawn_generator(0, "compared runs")
    found = compare_paired(after, before, weights, IntervalParameters(), generator)
    return Figure(found.difference.mean, found.difference.low, found.difference.high), found.p_value
