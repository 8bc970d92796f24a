"""The files and tables of a run, read once for all sections of the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.own_fixations import OwnFixations
from visuohaptic.geometry.surface import notes_of, object_of, set_aside_reason
from visuohaptic.meshes.catalogue import Credit, find_own_models, models_of_set, read_credits
from visuohaptic.parameters import ExperimentParameters, read_parameters
from visuohaptic.report.comparison import PipelineTable, pipeline_tables, without_published
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
"""File names relative to the run's folder."""

_TABLES = ("predictions", "views", "fixations", "touches", "features", "pictures")
_EXTRAS = {
    "studies": "results/studies",
    "frontier": "results/frontier.parquet",
    "effect_influence": "results/effect_influence.parquet",
    "evaluation": "reports/evaluation.parquet",
}
"""Paths relative to the run's folder, by the names of `extra_paths`."""


@dataclass(frozen=True)
class RunFiles:
    """Paths of a run's files; the default of an optional file is "no file".

    Attributes
    ----------
    metrics : path
        ``reports/metrics.json``.
    predictions, views, fixations, touches, features, pictures, effects, stability : sequence of paths
        The Parquet files of each table; `tables` has the schemas. Files of former runs in the same folders do not count.
    drawn : sequence of paths
        The Parquet files of study ``random_draws``, rows of `tables.STUDY`.
    meshes : sequence of paths
        Mesh files ``<block>/<class>/<object>.ply``.
    credits : sequence of paths
        CSV files for `read_credits`. A later file replaces an object's credit from an earlier file; missing files are
        skipped.
    logs : path, optional
        The folder of the jobs' logs.
    folder : path
        The run's folder; the page shows paths relative to this folder.
    extras : mapping of str to path
        Files and folders that not every run has, by the names of `extra_paths`. They need not exist.
    study_folders : sequence of paths
        Folders of study definitions. Each file ``<study>/section.py`` adds a section to the page.
    own_objects : sequence of str
        The user's own objects, `class/name`.
    key : str
        The digest of all inputs of the page, for the section on provenance; empty if unknown.
    """

    metrics: str | Path
    predictions: Sequence[str | Path]
    views: Sequence[str | Path]
    fixations: Sequence[str | Path]
    touches: Sequence[str | Path]
    features: Sequence[str | Path]
    pictures: Sequence[str | Path]
    effects: Sequence[str | Path] = ()
    stability: Sequence[str | Path] = ()
    drawn: Sequence[str | Path] = ()
    meshes: Sequence[str | Path] = ()
    credits: Sequence[str | Path] = ()
    logs: str | Path | None = None
    folder: str | Path = "."
    extras: Mapping[str, str | Path] = field(default_factory=dict)
    study_folders: Sequence[str | Path] = (REPOSITORY,)
    own_objects: Sequence[str] = ()
    key: str = ""


@dataclass(frozen=True)
class Run:
    """A run's tables in memory.

    Attributes
    ----------
    files : RunFiles
        The files that the tables were read from.
    parameters : ExperimentParameters
        The run's parameters.
    all_objects : tuple of str
        All objects of the set and the user's own objects, `class/name`, also objects that no table contains.
    metrics : mapping
        ``comparisons``, ``leads``, ``method``, ``own_fixations`` and ``results`` of ``reports/metrics.json``, as
        `evaluation.metrics.make_metrics` writes.
    fixations : pyarrow.Table
        Only the probing locations that were touched, one row per row of `touches` and in the same order. Column
        ``touch`` has the number of the touch.
    predictions, views, touches, features, pictures : pyarrow.Table
        All rows of the files.
    effects : pyarrow.Table
        All rows of the files; no rows if the run has no such files.
    """

    files: RunFiles
    parameters: ExperimentParameters
    all_objects: tuple[str, ...]
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
        """Accuracies and comparisons of each pipeline, the paper's pipeline first.

        Published accuracies are only in the tables of a run that `is_like_published`.
        """
        tables = pipeline_tables(self.metrics)
        return tables if self.is_like_published else [without_published(one) for one in tables]

    @property
    def is_like_published(self) -> bool:
        """Whether the run tests only upright objects of the paper's set, so that published accuracies are comparable."""
        own = set(self.files.own_objects)
        return (
            self.parameters.meshes.set == "paper"
            and self.parameters.meshes.turns == "none"
            and own.isdisjoint(self.tested_objects)
        )

    @property
    def own_fixations(self) -> OwnFixations | None:
        """Comparison of the touches with the fixations of the eye; None without touches by fixation."""
        found = self.metrics["own_fixations"]
        return None if found is None else OwnFixations(**found)

    @cached_property
    def objects(self) -> list[str]:
        """Objects that have rows in `views`, `class/name`, sorted."""
        return sorted(keys_of(self.views).unique().to_pylist())

    @cached_property
    def tested_objects(self) -> list[str]:
        """Objects that have rows in `predictions`, `class/name`, sorted."""
        return sorted(keys_of(self.predictions).unique().to_pylist())

    @cached_property
    def classes(self) -> list[str]:
        """Classes of `tested_objects`, sorted."""
        return sorted(self.predictions.column("class").unique().to_pylist())

    @cached_property
    def meshes(self) -> dict[str, Path]:
        """Existing mesh files by object, `class/name`."""
        paths = [Path(path) for path in self.files.meshes]
        return {object_of(path): path for path in paths if path.is_file()}

    @cached_property
    def set_aside(self) -> dict[str, str]:
        """Reasons why objects were set aside, by object, `class/name`, from the headers of the mesh files."""
        reasons = {key: set_aside_reason(path) for key, path in self.meshes.items()}
        return {key: reason for key, reason in reasons.items() if reason is not None}

    @cached_property
    def notes(self) -> dict[str, list[str]]:
        """Notes of the mesh conversion, by object, `class/name`, from the headers of the mesh files.

        Objects without notes are left out.
        """
        notes_by_object = {key: notes_of(path) for key, path in self.meshes.items()}
        return {key: notes for key, notes in notes_by_object.items() if notes}

    @cached_property
    def stability(self) -> StabilityFigures | None:
        """The numerical checks on this run's objects; None if the run has no table of checks."""
        parts = self.parts("stability")
        return stability_figures(read_table(STABILITY, parts)) if parts else None

    @cached_property
    def credits(self) -> dict[str, Credit]:
        """Credits by object, `class/name`; objects without a credit are left out."""
        return read_credits(self.files.credits)

    def extra_path(self, name: str) -> Path | None:
        """Return a file or folder of `files.extras` by name; None if the name is unknown or nothing exists there."""
        path = self.files.extras.get(name)
        return None if path is None or not Path(path).exists() else Path(path)

    def existing_file(self, file: str) -> Path | None:
        """Join a file's relative path to the run's folder; return None if no such file exists."""
        path = Path(self.files.folder, file)
        return path if path.is_file() else None

    def parts(self, name: str) -> list[Path]:
        """Return the Parquet files of a table, sorted; an empty list if there are none.

        Files of the run's own tables, such as ``predictions``, are returned in the order of `files`, without a test
        whether they exist.

        Parameters
        ----------
        name : str
            A table such as ``predictions``, a name of `files.extras` such as ``frontier``, a study as
            ``studies/NAME``, or the path of a Parquet file relative to the run's folder.
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
    """Read the tables of a run into memory; `objects` become `Run.all_objects`.

    Raises
    ------
    ReportError
        If the file of metrics can't be read, or lacks an entry of `Run.metrics`.
    TableError
        If a table does not fit its schema.
    """

    def take_figures(metrics: Any) -> Mapping[str, Any]:
        names = ("comparisons", "leads", "method", "own_fixations", "results")
        return {name: metrics[name] for name in names}

    fault, way_out = "holds no metrics of this workflow", "run rule metrics again"
    metrics = read_json(Path(files.metrics), take_figures, fault, way_out)
    touches = read_table(TOUCHES, files.touches)
    effects = files.effects
    return Run(
        files=files,
        parameters=parameters,
        all_objects=tuple(objects),
        metrics=metrics,
        predictions=read_table(PREDICTIONS, files.predictions),
        views=read_table(VIEWS, files.views),
        fixations=touched_locations(read_table(FIXATIONS, files.fixations), touches),
        touches=touches,
        features=read_table(FEATURES, files.features),
        pictures=read_table(PICTURES, files.pictures),
        effects=read_table(EFFECTS, effects) if effects else EFFECTS.arrow.empty_table(),
    )


def extra_paths(run: str | Path, checkout: str | Path) -> dict[str, Path]:
    """Return paths of files and folders that not every run has, by name, without a test whether they exist.

    The names are ``studies``, ``frontier``, ``effect_influence``, ``evaluation`` and ``hard_cases``. `checkout` is the
    folder of the repository, in which command `make test-hard` writes ``docs/figures/hard_cases.json``.
    """
    extras = {name: Path(run, path) for name, path in _EXTRAS.items()}
    return extras | {"hard_cases": Path(checkout, "docs/figures/hard_cases.json")}


def find_run(folder: str | Path) -> tuple[RunFiles, ExperimentParameters, tuple[str, ...]]:
    """Find the files of a finished run.

    Parameters
    ----------
    folder : str or Path
        The folder with ``params.yaml``, ``results`` and ``reports``.

    Returns
    -------
    files : RunFiles
        The run's files. `study_folders` and `key` keep their defaults.
    parameters : ExperimentParameters
        The parameters in its ``params.yaml``.
    objects : tuple of str
        `Run.all_objects`; without ``meshes/catalogue.csv`` the objects that have a mesh file.

    Raises
    ------
    ReportError
        If ``params.yaml``, ``reports/metrics.json`` or one of the tables ``predictions``, ``views``, ``fixations``,
        ``touches``, ``features`` and ``pictures`` is missing.
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
    own = find_own_models(folder / "meshes/own").models
    files = RunFiles(
        metrics=folder / METRICS,
        **tables,
        effects=[*_parts(results / "effects/views"), *_parts(results / "effects/touches")],
        stability=_parts(results / "stability"),
        drawn=_parts(results / "study_blocks/random_draws"),
        meshes=sorted((results / "meshes").rglob("*.ply")),
        credits=[folder / "meshes/catalogue.csv", folder / "meshes/paper/credits.csv"],
        logs=logs if logs.is_dir() else None,
        folder=folder,
        extras=extra_paths(folder, folder),
        own_objects=sorted(model.key for model in own),
    )
    return files, parameters, _objects(folder, parameters, files)


def _parts(folder: Path) -> list[Path]:
    """Return the Parquet files below a folder, sorted; an empty list for a missing folder."""
    return sorted(folder.rglob("*.parquet"))


def _objects(folder: Path, parameters: ExperimentParameters, files: RunFiles) -> tuple[str, ...]:
    """Return the set's and the user's own objects; without a catalogue the objects that have a mesh file."""
    catalogue = folder / "meshes/catalogue.csv"
    if not catalogue.is_file():
        return tuple(object_of(path) for path in files.meshes)
    catalogued = {model.key for model in models_of_set(catalogue, parameters.meshes.set)}
    added = find_own_models(folder / "meshes/own", catalogued)
    return tuple(sorted({*catalogued, *(model.key for model in added.models)}))
