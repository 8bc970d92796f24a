"""What changed from one run to another: parameters, and accuracies with their intervals."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.resources import files as package_files
from pathlib import Path
from typing import Any

from visuohaptic.errors import ReportError

MEASURES = ("accuracy", "object_accuracy", "balanced_accuracy")
_METRICS = "reports/metrics.json"
_PARAMETERS = "params.yaml"


@dataclass(frozen=True)
class Estimate:
    """A mean and its interval; None where the interval has no end."""

    mean: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class MeasuredRun:
    """One run's figures.

    Attributes
    ----------
    source : str
        The metrics file.
    parameters : mapping or None
        Each parameter by its path, such as ``sensor.resolution``; None where unknown.
    parameters_source : str
        Where they were found.
    figures : mapping
        By (measure, pipeline, strategy, classifier).
    """

    source: str
    parameters: Mapping[str, Any] | None
    parameters_source: str
    figures: Mapping[tuple[str, str, str, str], Estimate]


@dataclass(frozen=True)
class ChangedParameter:
    """A parameter that differs; None on a side that does not have it."""

    name: str
    first: str | None
    second: str | None


@dataclass(frozen=True)
class ChangedFigure:
    """One figure of both runs; None on a side that does not have it."""

    measure: str
    pipeline: str
    strategy: str
    classifier: str
    first: Estimate | None
    second: Estimate | None
    difference: Estimate | None

    @property
    def direction(self) -> str:
        """`higher` or `lower` where the difference's interval leaves out 0, else `open`."""
        found = self.difference
        if found is None or found.low is None or found.high is None:
            return "open"
        return "higher" if found.low > 0 else "lower" if found.high < 0 else "open"


@dataclass(frozen=True)
class RunComparison:
    """Everything that differs, or could have."""

    first: str
    second: str
    parameters_known: bool
    parameters: tuple[ChangedParameter, ...]
    figures: tuple[ChangedFigure, ...]

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
            name: sum(figure.direction == name for figure in shared) for name in ("higher", "lower")
        }
        return (
            f"{changed if self.parameters_known else 'parameters not known'}; "
            f"accuracies that both runs have: {len(shared)}; beyond their intervals, higher in the "
            f"second: {counts['higher']}, lower: {counts['lower']}."
        )

    def as_values(self) -> dict[str, Any]:
        """Give plain values, for machines."""
        values = asdict(self)
        for figure, plain in zip(self.figures, values["figures"], strict=True):
            plain["direction"] = figure.direction
        return values


def read_measured_run(source: str | Path) -> MeasuredRun:
    """Read a run's metrics, and its parameters where they can be found.

    Parameters
    ----------
    source : path or str
        A metrics file; or the folder of a run, which holds ``reports/metrics.json``; or a DVC
        experiment or Git revision of the repository around the working folder. A
        ``params.yaml`` beside the file or one folder above is taken as the run's.

    Returns
    -------
    MeasuredRun
        The run.

    Raises
    ------
    ReportError
        If there are no metrics, or they are not of this workflow.
    """
    path = Path(source)
    if not path.exists() and not path.suffix:
        return _read_experiment(str(source))
    file = path / _METRICS if path.is_dir() else path
    try:
        text = file.read_bytes()
    except OSError as error:
        raise ReportError(
            f"{file} can't be read: {error.strerror}; `snakemake -j2` makes a run's metrics."
        ) from error
    found = _find_parameters(file)
    values = None if found is None else _flat_yaml(found.read_bytes(), str(found))
    return MeasuredRun(str(file), values, str(found), _figures(text, str(file)))


def compare_runs(first: MeasuredRun, second: MeasuredRun) -> RunComparison:
    """Set two runs side by side.

    Parameters
    ----------
    first, second : MeasuredRun
        The runs; differences are second minus first.

    Returns
    -------
    RunComparison
        What differs.
    """
    # One file can't tell of two runs: it is what the later one was run with, at most.
    own = first.parameters_source != second.parameters_source or first.source == second.source
    known = own and first.parameters is not None and second.parameters is not None
    keys = dict.fromkeys([*first.figures, *second.figures])
    ordered = sorted(keys, key=lambda key: MEASURES.index(key[0]))
    return RunComparison(
        first.source,
        second.source,
        known,
        _changed_parameters(first.parameters or {}, second.parameters or {}) if known else (),
        tuple(_changed_figure(key, first, second) for key in ordered),
    )


def difference_of(first: Estimate, second: Estimate) -> Estimate:
    """Give the difference of two estimates, with an interval from theirs.

    Parameters
    ----------
    first, second : Estimate
        The estimates.

    Returns
    -------
    Estimate
        Second minus first.

    Notes
    -----
    The method of variance estimates recovery (G. Y. Zou, A. Donner, Statist. Med.
    27:1693-1702, 2008) for independent estimates. Runs over the same objects err
    together, so the true interval is narrower.
    """
    mean = second.mean - first.mean
    ends = (first.low, first.high, second.low, second.high)
    if None in ends:
        return Estimate(mean, None, None)
    low_1, high_1, low_2, high_2 = (float(end) for end in ends if end is not None)
    return Estimate(
        mean,
        mean - math.hypot(second.mean - low_2, high_1 - first.mean),
        mean + math.hypot(high_2 - second.mean, first.mean - low_1),
    )


def render_comparison(comparison: RunComparison) -> str:
    """Give the page of a comparison.

    Parameters
    ----------
    comparison : RunComparison
        What differs.

    Returns
    -------
    str
        HTML that asks the network for nothing.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from visuohaptic.report import wording

    environment = Environment(
        loader=PackageLoader("visuohaptic.cli"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "percent": wording.percent,
        "points": wording.points,
        "classifier": wording.classifier_name,
        "strategy": wording.strategy_name,
        "spaced": wording.spaced,
        "titled": wording.titled,
    }
    style = package_files("visuohaptic.report").joinpath("templates", "style.css")
    return environment.get_template("comparison.html.jinja").render(
        comparison=comparison, measures=MEASURES, style=style.read_text("utf-8")
    )


def _estimate(values: Mapping[str, Any]) -> Estimate:
    mean, low, high = float(values["mean"]), values["low"], values["high"]
    return Estimate(
        mean, None if low is None else float(low), None if high is None else float(high)
    )


def _read_experiment(name: str) -> MeasuredRun:
    import dvc.api  # type: ignore[import-untyped]
    from dvc.exceptions import DvcException  # type: ignore[import-untyped]

    try:
        metrics, parameters = (
            dvc.api.read(path, rev=name).encode() for path in (_METRICS, _PARAMETERS)
        )
    # DVC and the Git libraries below it raise whatever comes; what is wrong is the name.
    except (DvcException, OSError, ValueError, KeyError) as error:
        raise ReportError(
            f"{name} is no file, and no experiment of this repository that has {_METRICS} "
            f"({error}); `dvc exp show` lists the experiments."
        ) from error
    source = f"{name}:{_PARAMETERS}"
    return MeasuredRun(name, _flat_yaml(parameters, source), source, _figures(metrics, name))


def _figures(text: bytes, source: str) -> dict[tuple[str, str, str, str], Estimate]:
    try:
        return {
            (measure, pipeline, strategy, classifier): _estimate(figures[measure])
            for pipeline, strategies in json.loads(text)["results"].items()
            for strategy, classifiers in strategies.items()
            for classifier, figures in classifiers.items()
            for measure in MEASURES
            if measure in figures
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ReportError(
            f"{source} holds no metrics of this workflow; {_METRICS} of a run is needed."
        ) from error


def _find_parameters(file: Path) -> Path | None:
    folder = file.resolve().parent
    beside = (folder / _PARAMETERS, folder.parent / _PARAMETERS)
    return next((path for path in beside if path.is_file()), None)


def _flat_yaml(text: bytes, source: str) -> dict[str, Any]:
    import yaml

    try:
        values = yaml.safe_load(text)
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise ReportError(f"{source} can't be read as YAML; mend it or take it away.") from error
    return _flat(values) if isinstance(values, dict) else {}


def _flat(values: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in values.items():
        path = f"{above}{name}"
        flat |= _flat(value, f"{path}.") if isinstance(value, dict) else {path: value}
    return flat


def _changed_parameters(
    first: Mapping[str, Any], second: Mapping[str, Any]
) -> tuple[ChangedParameter, ...]:
    names = dict.fromkeys([*first, *second])
    texts = [
        ChangedParameter(name, *(_text(side, name) for side in (first, second))) for name in names
    ]
    return tuple(change for change in texts if change.first != change.second)


def _text(side: Mapping[str, Any], name: str) -> str | None:
    return json.dumps(side[name], ensure_ascii=False, default=str) if name in side else None


def _changed_figure(
    key: tuple[str, str, str, str], first: MeasuredRun, second: MeasuredRun
) -> ChangedFigure:
    before, after = first.figures.get(key), second.figures.get(key)
    both = before is not None and after is not None
    return ChangedFigure(
        *key,
        first=before,
        second=after,
        difference=difference_of(before, after) if both else None,  # type: ignore[arg-type]
    )
