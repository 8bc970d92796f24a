"""The files and tables of a run, read once for all sections of the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.base.errors import ReportError
from visuohaptic.geometry.surface import notes_of, object_of, set_aside_reason
from visuohaptic.meshes.catalogue import Credit, find_own_models, models_of_set, read_credits
from visuohaptic.parameters import ExperimentParameters, read_parameters
from visuohaptic.report.comparison import PipelineTable, read_tables
from visuohaptic.report.estimates import read_json
from visuohaptic.report.stability import StabilityFigures, stability_figures
from visuohaptic.studies.registry import REPOSITORY
from visuohaptic.tables.phases import (
    EFFECTS,
    FEATURES,
    FIXATIONS,
    PREDICTIONS,
    TOUCHES,
    VIEWS,
    keys_of,
)
from visuohaptic.tables.pictures import PICTURES
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.stability import STABILITY
from visuohaptic.touches.choosing import touched_locations

METRICS = "reports/metrics.json"
PARAMETERS = "params.yaml"

_TABLES = ("predictions", "views", "fixations", "touches", "features", "pictures")
_EXTRAS = {
    "studies": "results/studies",
    "frontier": "results/frontier.parquet",
    "drawn": "results/study_blocks/random_draws",
    "effect_influence": "results/effect_influence.parquet",
    "evaluation": "reports/evaluation.parquet",
    "stability": "results/stability",
}


@dataclass(frozen=True)
class RunFiles:
    """Paths of a run's files. Optional files have a default.

    Attributes
    ----------
    metrics : path
        ``reports/metrics.json``.
    predictions, views, fixations, touches, features, pictures, effects : sequence of paths
        The parts of each table, in the schemas of `tables`.
    meshes : sequence of paths
        Mesh files ``<block>/<class>/<object>.ply``.
    credits : sequence of paths
        Files of credits; later files add to earlier files.
    logs : path, optional
        The folder of the jobs' logs.
    folder : path
        The run's folder; the page shows paths relative to this folder.
    extras : mapping of str to path
        Files and folders of tables that not every run has, by name.
    earlier_studies : mapping of str to str
        Studies that were measured with an earlier state, and the date of that state.
    studies : sequence of paths
        Folders of studies that may bring sections of their own.
    gaze : path, optional
        The table that `gaze.gaze_sentence` reads.
    key : str
        The digest of all inputs of the page.
    """

    metrics: str | Path
    predictions: Sequence[str | Path]
    views: Sequence[str | Path]
    fixations: Sequence[str | Path]
    touches: Sequence[str | Path]
    features: Sequence[str | Path]
    pictures: Sequence[str | Path]
    effects: Sequence[str | Path] = ()
    meshes: Sequence[str | Path] = ()
    credits: Sequence[str | Path] = ()
    logs: str | Path | None = None
    folder: str | Path = "."
    extras: Mapping[str, str | Path] = field(default_factory=dict)
    earlier_studies: Mapping[str, str] = field(default_factory=dict)
    studies: Sequence[str | Path] = (REPOSITORY,)
    gaze: str | Path | None = None
    key: str = ""


@dataclass(frozen=True)
class Run:
    """A run's tables in memory; `named_objects` are all objects of the set, `class/name`."""

    files: RunFiles
    parameters: ExperimentParameters
    named_objects: tuple[str, ...]
    metrics: Mapping[str, Any]
    predictions: pa.Table
    views: pa.Table
    fixations: pa.Table
    touches: pa.Table
    features: pa.Table
    pictures: pa.Table
    effects: pa.Table

    @cached_property
    def pipelines(self) -> list[PipelineTable]:
        """The accuracies of each pipeline, the paper's pipeline first."""
        return read_tables(self.metrics)

    @cached_property
    def objects(self) -> list[str]:
        """Objects with views, `class/name`, sorted."""
        return sorted(keys_of(self.views).unique().to_pylist())

    @cached_property
    def tested_objects(self) -> list[str]:
        """Objects that recognition tested, `class/name`, sorted."""
        return sorted(keys_of(self.predictions).unique().to_pylist())

    @cached_property
    def classes(self) -> list[str]:
        """Classes that recognition distinguishes, sorted."""
        return sorted(self.predictions.column("class").unique().to_pylist())

    @cached_property
    def meshes(self) -> dict[str, Path]:
        """The mesh file of each object, `class/name`; objects without a file are left out."""
        paths = [Path(path) for path in self.files.meshes]
        return {object_of(path): path for path in paths if path.is_file()}

    @cached_property
    def set_aside(self) -> dict[str, str]:
        """The reason why an object can't be used, by object, `class/name`."""
        reasons = {key: set_aside_reason(path) for key, path in self.meshes.items()}
        return {key: reason for key, reason in reasons.items() if reason is not None}

    @cached_property
    def notes(self) -> dict[str, list[str]]:
        """Notes on the model's file, by object, `class/name`; objects without notes are left out."""
        notes_by_object = {key: notes_of(path) for key, path in self.meshes.items()}
        return {key: notes for key, notes in notes_by_object.items() if notes}

    @cached_property
    def stability(self) -> StabilityFigures | None:
        """The numerical checks on this run's objects; None without files of checks."""
        parts = self.parts("stability")
        return stability_figures(read_table(STABILITY, parts)) if parts else None

    @cached_property
    def credits(self) -> dict[str, Credit]:
        """The credit of each object, `class/name`; objects without a credit are left out."""
        return read_credits(self.files.credits)

    def file_of(self, name: str) -> Path | None:
        """Return the file or folder of an extra table by its name; None if it does not exist."""
        path = self.files.extras.get(name)
        return None if path is None or not Path(path).exists() else Path(path)

    def existing_file(self, file: str) -> Path | None:
        """Return a file by its path relative to the run's folder; None if it does not exist."""
        path = Path(self.files.folder, file)
        return path if path.is_file() else None

    def parts(self, name: str) -> list[Path]:
        """Return the existing files of a table.

        Parameters
        ----------
        name : str
            A table such as ``predictions`` or ``frontier``, a study as ``studies/NAME``, or the path of a Parquet file
            relative to the run's folder.
        """
        if name.endswith(".parquet"):
            return [path] if (path := self.existing_file(name)) else []
        extra, _, study = name.partition("/")
        if extra not in self.files.extras:
            return [Path(path) for path in getattr(self.files, name, ())]
        path = Path(self.files.extras[extra], f"{study}.parquet" if study else "")
        if path.is_dir():
            return sorted(path.rglob("*.parquet"))
        return [path] if path.is_file() else []


def read_run(files: RunFiles, parameters: ExperimentParameters, objects: Sequence[str]) -> Run:
    """Read the tables of a run into memory.

    Parameters
    ----------
    files : RunFiles
        The run's files.
    parameters : ExperimentParameters
        The run's parameters.
    objects : sequence of str
        All objects of the set, `class/name`.

    Raises
    ------
    ReportError
        If the file of metrics was not written by this workflow.
    TableError
        If a table does not fit its schema.
    """

    def take_figures(metrics: Any) -> Mapping[str, Any]:
        return {name: metrics[name] for name in ("comparisons", "method", "results")}

    fault, way_out = "holds no metrics of this workflow", "run rule metrics again"
    metrics = read_json(Path(files.metrics), take_figures, fault, way_out)
    touches = read_table(TOUCHES, files.touches)
    effects = files.effects
    return Run(
        files=files,
        parameters=parameters,
        named_objects=tuple(objects),
        metrics=metrics,
        predictions=read_table(PREDICTIONS, files.predictions),
        views=read_table(VIEWS, files.views),
        fixations=touched_locations(read_table(FIXATIONS, files.fixations), touches),
        touches=touches,
        features=read_table(FEATURES, files.features),
        pictures=read_table(PICTURES, files.pictures),
        effects=read_table(EFFECTS, effects) if effects else EFFECTS.arrow.empty_table(),
    )


def find_extras(run: str | Path, checks: str | Path) -> dict[str, Path]:
    """Return the paths of tables that not every run has, by name; the files need not exist.

    `run` is the folder of the run, `checks` the folder in which `make test-hard` ran.
    """
    extras = {name: Path(run, path) for name, path in _EXTRAS.items()}
    return extras | {"hard_cases": Path(checks, "docs/figures/hard_cases.json")}


def find_run(folder: str | Path) -> tuple[RunFiles, ExperimentParameters, tuple[str, ...]]:
    """Find the files of a run in its folder.

    Returns
    -------
    files : RunFiles
        The run's files.
    parameters : ExperimentParameters
        The parameters in its ``params.yaml``.
    objects : tuple of str
        All objects of the set, `class/name`.

    Raises
    ------
    ReportError
        If the parameters, the metrics or a table is missing.
    """
    folder = Path(folder)
    results = folder / "results"
    for name in (PARAMETERS, *(f"results/{table}" for table in _TABLES), METRICS):
        if not (folder / name).is_file() and not _parts(folder / name):
            raise ReportError(
                f"{folder / name} does not exist; the report needs the folder of a finished run, so run "
                "`snakemake -j2` there first, or name another folder."
            )
    parameters = read_parameters(folder / PARAMETERS)
    tables: dict[str, Any] = {name: _parts(results / name) for name in _TABLES}
    tables["fixations"] += _parts(results / "policy_fixations")
    logs = folder / "logs"
    files = RunFiles(
        metrics=folder / METRICS,
        **tables,
        effects=[*_parts(results / "effects/views"), *_parts(results / "effects/touches")],
        meshes=sorted((results / "meshes").rglob("*.ply")),
        credits=[folder / "meshes/catalogue.csv", folder / "meshes/paper/credits.csv"],
        logs=logs if logs.is_dir() else None,
        folder=folder,
        extras=find_extras(folder, folder),
    )
    return files, parameters, _objects(folder, parameters, files)


def _parts(folder: Path) -> list[Path]:
    return sorted(folder.rglob("*.parquet"))


def _objects(folder: Path, parameters: ExperimentParameters, files: RunFiles) -> tuple[str, ...]:
    catalogue = folder / "meshes/catalogue.csv"
    if not catalogue.is_file():
        return tuple(object_of(path) for path in files.meshes)
    catalogued = {model.key for model in models_of_set(catalogue, parameters.meshes.set)}
    added = find_own_models(folder / "meshes/own", catalogued)
    return tuple(sorted({*catalogued, *(model.key for model in added.models)}))
