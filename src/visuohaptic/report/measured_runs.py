"""A run to be compared with others: its figures, and what else its folder, report or experiment says of it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from visuohaptic.errors import ReportError
from visuohaptic.optional_packages import require
from visuohaptic.report.archive import Archive, read_archive
from visuohaptic.report.estimates import Figure
from visuohaptic.report.run_folder import METRICS, PARAMETERS

MEASURES = ("accuracy", "object_accuracy", "balanced_accuracy")

Cell = tuple[str, str, str]
"""Pipeline, strategy and classifier."""

_REPORT = "report.html"


class CellFigures(BaseModel):
    """What the metrics say of a cell; `by_object` has each object's accuracy and its weight."""

    accuracy: Figure | None = None
    object_accuracy: Figure | None = None
    balanced_accuracy: Figure | None = None
    by_object: dict[str, tuple[float, float]]


@dataclass(frozen=True)
class MeasuredRun:
    """One run's figures by cell, and where they and its parameters were read from.

    `parameters` are as in ``params.yaml``, None where unknown; `archive` is what the run's report
    carries, None where no report of these figures is at hand.
    """

    source: str
    parameters: Mapping[str, Any] | None
    parameters_source: str
    cells: Mapping[Cell, CellFigures]
    archive: Archive | None = None

    def figure(self, measure: str, cell: Cell) -> Figure | None:
        """Give one of `MEASURES` of a cell; None where it is missing."""
        return getattr(self.cells.get(cell), measure, None)


def read_measured_run(source: str | Path) -> MeasuredRun:
    """Read a run's metrics, and what else of it can be found.

    `source` is a metrics file, or a report; or the folder of a run or of its reports; or a DVC
    experiment or Git revision of the repository around the working folder. Of a metrics file with
    its own report beside it, the report gives parameters, seconds, code, packages and machine;
    without one, a ``params.yaml`` beside the file or one folder above is taken as the run's. Raises
    `ReportError` if there are no metrics, or they are not of this workflow.
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
        carried = json.dumps(archive.metrics)
        return _measured(str(file), carried, archive.parameters, f"{file}: report", archive)
    found = _find_parameters(file)
    values = None if found is None else _yaml(found.read_bytes(), str(found))
    report = file.parent / _REPORT
    page = report.read_text("utf-8", "replace") if report.is_file() else ""
    return _beside(str(file), content, values, str(found), page)


def list_experiments() -> list[str]:
    """Name the experiments that DVC keeps of the repository around the working folder; `ReportError` if none."""
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
            dvc.api.read(path, rev=name).encode() for path in (METRICS, PARAMETERS)
        )
    # DVC and the Git libraries below it raise many types; the cause is a wrong name.
    except (DvcException, OSError, ValueError, KeyError) as error:
        raise ReportError(
            f"{name} is no file, and no experiment of this repository that has {METRICS} "
            f"({error}); `dvc exp show` lists the experiments."
        ) from error
    source = f"{name}:{PARAMETERS}"
    try:
        page = dvc.api.read(f"reports/{_REPORT}", rev=name)
    except (DvcException, OSError, ValueError, KeyError):
        page = ""  # kept by DVC, and perhaps not at hand
    return _beside(name, metrics, _yaml(parameters, source), source, page)


def _beside(
    source: str,
    metrics: bytes,
    parameters: Mapping[str, Any] | None,
    parameters_source: str,
    page: str,
) -> MeasuredRun:
    """Take the report beside a metrics file, unless it is missing or of other figures."""
    alone = _measured(source, metrics, parameters, parameters_source)
    try:
        archive = read_archive(page, source)
        carried = json.dumps(archive.metrics)
        found = _measured(source, carried, archive.parameters, f"{source}: report", archive)
    except ReportError:
        return alone
    return found if found.cells == alone.cells else alone


class _Metrics(BaseModel):
    results: dict[str, dict[str, dict[str, CellFigures]]]


def _measured(
    source: str,
    metrics: bytes | str,
    parameters: Mapping[str, Any] | None,
    parameters_source: str,
    archive: Archive | None = None,
) -> MeasuredRun:
    try:
        results = _Metrics.model_validate_json(metrics).results
    except ValidationError as error:
        raise ReportError(
            f"{source} holds no metrics of this workflow; {METRICS} of a run is needed."
        ) from error
    cells = {
        (pipeline, strategy, classifier): cell
        for pipeline, strategies in results.items()
        for strategy, classifiers in strategies.items()
        for classifier, cell in classifiers.items()
    }
    return MeasuredRun(source, parameters, parameters_source, cells, archive)


def _metrics_file(path: Path) -> Path:
    """Find the file of a run that was named by its folder or by the folder of its reports."""
    if not path.is_dir():
        return path
    of_reports = path / Path(METRICS).name
    return of_reports if of_reports.is_file() else path / METRICS


def _find_parameters(file: Path) -> Path | None:
    folder = file.resolve().parent
    beside = (folder / PARAMETERS, folder.parent / PARAMETERS)
    return next((path for path in beside if path.is_file()), None)


def _yaml(text: bytes, source: str) -> dict[str, Any]:
    import yaml

    try:
        values = yaml.safe_load(text)
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise ReportError(f"{source} can't be read as YAML; correct it or delete it.") from error
    return values if isinstance(values, dict) else {}
