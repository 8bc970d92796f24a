"""A run to be compared with others: its figures, and what else its folder, report or experiment says of it.

A page carries its run for other programs, so that a report alone can be compared with another.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ValidationError

from visuohaptic.errors import ReportError
from visuohaptic.optional_packages import require
from visuohaptic.report.estimates import Figure
from visuohaptic.report.provenance import (
    PhaseSeconds,
    describe_machine,
    find_commit,
    find_versions,
)
from visuohaptic.report.run import METRICS, PARAMETERS, Run

MEASURES = ("accuracy", "object_accuracy", "balanced_accuracy")

Cell = tuple[str, str, str]
"""Pipeline, strategy and classifier."""

_REPORT = "report.html"
_SUMMARY = re.compile(r'<script type="application/json" id="run-summary">(.*?)</script>', re.DOTALL)


class Archive(BaseModel):
    """A run as its report carries it: whole `metrics.json` and `params.yaml`, and what `provenance` found.

    `form` is raised where an older reader would misread what is written.
    """

    form: Literal[1] = 1
    metrics: dict[str, Any]
    parameters: dict[str, Any]
    seconds: tuple[PhaseSeconds, ...]
    commit: str
    machine: dict[str, str]
    versions: dict[str, str]


def summarise_run(run: Run, seconds: Sequence[PhaseSeconds]) -> dict[str, Any]:
    """Give what the page carries, JSON-able."""
    return Archive(
        metrics=dict(run.metrics),
        parameters=run.parameters.model_dump(mode="json", exclude={"workflow"}),
        seconds=tuple(seconds),
        commit=find_commit(),
        machine=dict(describe_machine()),
        versions=dict(find_versions()),
    ).model_dump(mode="json")


def read_archive(page: str, source: str) -> Archive:
    """Read what a page carries; `ReportError` if it is no report of this workflow, or of another form."""
    found = _SUMMARY.search(page)
    try:
        return Archive.model_validate_json(found[1] if found else "")
    except ValidationError as error:
        (fault, *_) = error.errors()
        raise ReportError(
            f"{source} carries no run that can be read ({'.'.join(map(str, fault['loc']))}: {fault['msg']}); "
            "a report that `visuohaptic report` or `snakemake -j2` wrote is needed."
        ) from error


class CellFigures(BaseModel):
    """What the metrics say of a cell; `by_object` has each object's accuracy and its weight."""

    accuracy: Figure | None = None
    object_accuracy: Figure | None = None
    balanced_accuracy: Figure | None = None
    by_object: dict[str, tuple[float, float]]


class _Metrics(BaseModel):
    results: dict[str, dict[str, dict[str, CellFigures]]]


@dataclass(frozen=True)
class MeasuredRun:
    """One run's figures by cell, and where they and its parameters were read from; None is unknown."""

    source: str
    parameters: Mapping[str, Any] | None
    parameters_source: str
    cells: Mapping[Cell, CellFigures]
    archive: Archive | None = None


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
    if path.is_dir():
        of_reports = path / Path(METRICS).name
        path = of_reports if of_reports.is_file() else path / METRICS
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ReportError(
            f"{path} can't be read: {error.strerror}; `snakemake -j2` makes a run's metrics."
        ) from error
    if path.suffix == ".html":
        return _of_report(content.decode("utf-8", "replace"), str(path))
    report, folder = path.parent / _REPORT, path.resolve().parent
    beside = (folder / PARAMETERS, folder.parent / PARAMETERS)
    found = next((file for file in beside if file.is_file()), None)
    values = None if found is None else _yaml(found.read_bytes(), str(found))
    page = report.read_text("utf-8", "replace") if report.is_file() else ""
    return _beside(MeasuredRun(str(path), values, str(found), _cells(content, str(path))), page)


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

    # DVC and the Git libraries below it raise many types; the cause is a wrong name.
    failures = (DvcException, OSError, ValueError, KeyError)
    try:
        metrics, parameters = (dvc.api.read(path, rev=name) for path in (METRICS, PARAMETERS))
    except failures as error:
        raise ReportError(
            f"{name} is no file, and no experiment of this repository that has {METRICS} "
            f"({error}); `dvc exp show` lists the experiments."
        ) from error
    try:
        page = dvc.api.read(f"reports/{_REPORT}", rev=name)
    except failures:
        page = ""  # kept by DVC, and perhaps not at hand
    source = f"{name}:{PARAMETERS}"
    run = MeasuredRun(name, _yaml(parameters.encode(), source), source, _cells(metrics, name))
    return _beside(run, page)


def _beside(run: MeasuredRun, page: str) -> MeasuredRun:
    """Take the report beside a metrics file, unless it is missing or of other figures."""
    try:
        found = _of_report(page, run.source)
    except ReportError:
        return run
    return found if found.cells == run.cells else run


def _of_report(page: str, source: str) -> MeasuredRun:
    archive = read_archive(page, source)
    cells = _cells(json.dumps(archive.metrics), source)
    return MeasuredRun(source, archive.parameters, f"{source}: report", cells, archive)


def _cells(metrics: bytes | str, source: str) -> dict[Cell, CellFigures]:
    try:
        results = _Metrics.model_validate_json(metrics).results
    except ValidationError as error:
        raise ReportError(
            f"{source} holds no metrics of this workflow; {METRICS} of a run is needed."
        ) from error
    return {
        (pipeline, strategy, classifier): cell
        for pipeline, strategies in results.items()
        for strategy, classifiers in strategies.items()
        for classifier, cell in classifiers.items()
    }


def _yaml(text: bytes, source: str) -> dict[str, Any]:
    import yaml

    try:
        values = yaml.safe_load(text)
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise ReportError(f"{source} can't be read as YAML; correct it or delete it.") from error
    return values if isinstance(values, dict) else {}
