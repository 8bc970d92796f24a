"""Where a run left what it made: the folder of an experiment, as the workflow lays it out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from visuohaptic.errors import ReportError
from visuohaptic.geometry.surface import object_of
from visuohaptic.meshes.catalogue import find_own_models, models_of_set
from visuohaptic.parameters import ExperimentParameters, read_parameters
from visuohaptic.report.run import RunFiles

METRICS = "reports/metrics.json"
PARAMETERS = "params.yaml"

_TABLES = ("predictions", "views", "fixations", "touches", "features", "pictures")
_EXTRAS = {
    "studies": "results/studies",
    "frontier": "results/frontier.parquet",
    "effect_influence": "results/effect_influence.parquet",
    "touches_needed": "results/touches_needed.parquet",
    "cost": "results/cost.parquet",
    "certainty": "results/certainty.parquet",
    "certainty_figures": "reports/certainty.json",
    "looking": "results/looking.parquet",
    "looking_figures": "reports/looking.json",
    "evaluation": "reports/evaluation.parquet",
    "readings": "reports/readings.json",
    "gaze": "results/gaze/measured.parquet",
    "gaze_pictures": "results/gaze/pictures.parquet",
    "stability": "results/stability",
    "guards": "results/guards.parquet",
}
_KERNELS = "reports/precision.json"


def find_extras(run: str | Path, checks: str | Path) -> dict[str, Path]:
    """Name the tables that not every run has, whether they are there or not; `checks` is where `make test-hard` ran."""
    found = {name: Path(run, path) for name, path in _EXTRAS.items()}
    return found | {"precision": Path(checks, _KERNELS)}


def find_run(folder: str | Path) -> tuple[RunFiles, ExperimentParameters, tuple[str, ...]]:
    """Find a run's tables in its folder, its parameters, and the objects that were to take part, `class/name`.

    Raises `ReportError` if the parameters, the metrics or a table is missing.
    """
    folder = Path(folder)
    results = folder / "results"
    tables: dict[str, Any] = {name: _parts(results / name) for name in _TABLES}
    needed = {
        PARAMETERS: (folder / PARAMETERS).is_file(),
        **{f"results/{name}": bool(parts) for name, parts in tables.items()},
        METRICS: (folder / METRICS).is_file(),
    }
    missing = next((name for name, there in needed.items() if not there), None)
    if missing is not None:
        raise ReportError(
            f"{folder / missing} is not there, and the report needs it; name the folder of a "
            "finished run, or run `snakemake -j2` there first."
        )
    parameters = read_parameters(folder / PARAMETERS)
    logs = folder / "logs"
    files = RunFiles(
        metrics=folder / METRICS,
        **tables,
        effects=[*_parts(results / "effects/views"), *_parts(results / "effects/touches")],
        meshes=sorted((results / "meshes").glob("*/*/*.ply")),
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
    own = find_own_models(folder / "meshes/own", catalogued)
    return tuple(sorted({*catalogued, *(model.key for model in own.models)}))
