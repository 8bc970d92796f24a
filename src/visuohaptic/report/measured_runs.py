"""A run to be compared with others: its figures, and what else its folder, report or experiment says of it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visuohaptic.errors import ReportError
from visuohaptic.optional_packages import require
from visuohaptic.report.archive import Archive, read_archive
from visuohaptic.report.estimates import Figure

MEASURES = ("accuracy", "object_accuracy", "balanced_accuracy")
METRICS = "reports/metrics.json"

Cell = tuple[str, str, str]
"""Pipeline, strategy and classifier."""
ByObject = Mapping[str, tuple[float, float]]
"""An object's accuracy and its weight, by its name."""

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
        By measure and cell.
    by_object : mapping
        By cell; empty for a cell whose metrics are of a version that kept none.
    archive : Archive or None
        What the run's report carries; None where no report of these figures is at hand.
    """

    source: str
    parameters: Mapping[str, Any] | None
    parameters_source: str
    figures: Mapping[tuple[str, Cell], Figure]
    by_object: Mapping[Cell, ByObject]
    archive: Archive | None = None


def read_measured_run(source: str | Path) -> MeasuredRun:
    """Read a run's metrics, and what else of it can be found.

    `source` is a metrics file, or a report; or the folder of a run or of its reports; or a DVC
    experiment or Git revision of the repository around the working folder. Of a metrics file with
    its own report beside it, the report gives parameters, seconds, code, packages and machine;
    without one, a ``params.yaml`` beside the file or one folder above is taken as the run's.

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
        archive = read_archive(content.decode("utf-8", "replace"), str(file))
        return _measured(str(file), archive.metrics, archive.parameters, f"{file}: report", archive)
    found = _find_parameters(file)
    values = None if found is None else _yaml(found.read_bytes(), str(found))
    report = file.parent / _REPORT
    page = report.read_text("utf-8", "replace") if report.is_file() else ""
    return _beside(str(file), _parsed(content, str(file)), values, str(found), page)


def list_experiments() -> list[str]:
    """Name the experiments that DVC keeps of the repository around the working folder.

    Raises `ReportError` if there is none.
    """
    require("workflow", "dvc")
    import dvc.api  # type: ignore[import-untyped]
    from dvc.exceptions import DvcException  # type: ignore[import-untyped]

    try:
        names = [row["Experiment"] for row in dvc.api.exp_show() if row.get("Experiment")]
    except (DvcException, OSError, ValueError) as error:
        raise ReportError(f"The experiments of DVC can't be listed: {error}.") from error
    if not names:
        raise ReportError("DVC keeps no experiment here; `dvc exp run` makes one.")
    return names


def _read_experiment(name: str) -> MeasuredRun:
    require("workflow", "dvc")
    import dvc.api
    from dvc.exceptions import DvcException

    try:
        metrics, parameters = (
            dvc.api.read(path, rev=name).encode() for path in (METRICS, _PARAMETERS)
        )
    # DVC and the Git libraries below it raise many types; the cause is a wrong name.
    except (DvcException, OSError, ValueError, KeyError) as error:
        raise ReportError(
            f"{name} is no file, and no experiment of this repository that has {METRICS} "
            f"({error}); `dvc exp show` lists the experiments."
        ) from error
    source = f"{name}:{_PARAMETERS}"
    try:
        page = dvc.api.read(f"reports/{_REPORT}", rev=name)
    except (DvcException, OSError, ValueError, KeyError):
        page = ""  # kept by DVC, and perhaps not at hand
    return _beside(name, _parsed(metrics, name), _yaml(parameters, source), source, page)


def _beside(
    source: str,
    metrics: Mapping[str, Any],
    parameters: Mapping[str, Any] | None,
    parameters_source: str,
    page: str,
) -> MeasuredRun:
    """Take the report beside a metrics file, unless it is missing or of other figures."""
    alone = _measured(source, metrics, parameters, parameters_source)
    try:
        archive = read_archive(page, source)
        found = _measured(source, metrics, archive.parameters, f"{source}: report", archive)
        return found if _figures(archive.metrics, source) == alone.figures else alone
    except ReportError:
        return alone


def _measured(
    source: str,
    metrics: Mapping[str, Any],
    parameters: Mapping[str, Any] | None,
    parameters_source: str,
    archive: Archive | None = None,
) -> MeasuredRun:
    return MeasuredRun(
        source,
        parameters,
        parameters_source,
        _figures(metrics, source),
        _by_object(metrics, source),
        archive,
    )


def _metrics_file(path: Path) -> Path:
    """Find the file of a run that was named by its folder or by the folder of its reports."""
    if not path.is_dir():
        return path
    of_reports = path / Path(METRICS).name
    return of_reports if of_reports.is_file() else path / METRICS


def _parsed(content: bytes, source: str) -> Mapping[str, Any]:
    try:
        values = json.loads(content)
    except ValueError as error:
        raise _no_metrics(source) from error
    if not isinstance(values, dict):
        raise _no_metrics(source)
    return values


def _cells(metrics: Mapping[str, Any], source: str) -> dict[Cell, Mapping[str, Any]]:
    try:
        return {
            (pipeline, strategy, classifier): figures
            for pipeline, strategies in metrics["results"].items()
            for strategy, classifiers in strategies.items()
            for classifier, figures in classifiers.items()
        }
    except (KeyError, TypeError, AttributeError) as error:
        raise _no_metrics(source) from error


def _figures(metrics: Mapping[str, Any], source: str) -> dict[tuple[str, Cell], Figure]:
    try:
        return {
            (measure, cell): _estimate(figures[measure])
            for measure in MEASURES
            for cell, figures in _cells(metrics, source).items()
            if measure in figures
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise _no_metrics(source) from error


def _by_object(metrics: Mapping[str, Any], source: str) -> dict[Cell, ByObject]:
    try:
        return {
            cell: {
                name: (float(accuracy), float(weight))
                for name, (accuracy, weight) in figures.get("by_object", {}).items()
            }
            for cell, figures in _cells(metrics, source).items()
        }
    except (ValueError, TypeError, AttributeError) as error:
        raise _no_metrics(source) from error


def _estimate(values: Mapping[str, Any]) -> Figure:
    mean, low, high = float(values["mean"]), values["low"], values["high"]
    return Figure(mean, None if low is None else float(low), None if high is None else float(high))


def _no_metrics(source: str) -> ReportError:
    return ReportError(f"{source} holds no metrics of this workflow; {METRICS} of a run is needed.")


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
