"""From a run's tables to the cost tables, file to file."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.errors import RecognitionError
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.metrics import round_numbers
from visuohaptic.recognition.summary import select
from visuohaptic.studies.cost.errors import RunTables, measure_errors, setting_features
from visuohaptic.studies.cost.front import join_costs, read_costs
from visuohaptic.studies.cost.seconds import Ready, make_ready, measure_seconds
from visuohaptic.studies.cost.settings import (
    STRATEGY,
    Changes,
    Setting,
    condition_of,
    family_settings,
)
from visuohaptic.tables.phases import FEATURES, FIXATIONS
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import COST, COST_ERRORS, COST_SECONDS

FIGURES = ("error", "error_low", "error_high", "objects", "failed")
"""What is told of a setting to machines that compare runs."""


def make_cost_errors(
    family: str,
    meshes: Sequence[str | Path],
    fixations: Sequence[str | Path],
    features: Sequence[str | Path],
    output: str | Path,
    described: str | Path,
    parameters: ExperimentParameters,
) -> None:
    """Measure the error rates of a family, and keep the features that it needed.

    Parameters
    ----------
    family : str
        One of `settings.FAMILIES`.
    meshes : sequence of path
        Surfaces of all objects, ``<class>/<object>.ply``.
    fixations, features : sequence of path
        The run's tables, all parts.
    output : path
        The Parquet file to write.
    described : path
        Folder for the features that the run does not have: one file a condition.
    parameters : ExperimentParameters
        The run's.
    """
    settings = family_settings(family, parameters)
    tables = _run_tables(fixations, features)
    found = setting_features(_surfaces(meshes), settings, tables, parameters)
    folder = Path(described)
    folder.mkdir(parents=True, exist_ok=True)
    for place, value in enumerate(found.values()):
        if isinstance(value, pa.Table):
            write_table(FEATURES, value, folder / f"{place}.parquet")
        else:
            (folder / f"{place}.txt").write_text(value, encoding="utf-8")
    write_table(COST_ERRORS, measure_errors(settings, found, parameters), output)


def make_cost_seconds(
    meshes: Sequence[str | Path],
    described: Mapping[str, str | Path],
    output: str | Path,
    parameters: ExperimentParameters,
) -> None:
    """Time every setting of every family side by side.

    Parameters
    ----------
    meshes : sequence of path
        Surfaces of the objects on which time is taken.
    described : mapping of str to path
        What `make_cost_errors` kept of each family.
    output : path
        The Parquet file to write.
    parameters : ExperimentParameters
        The run's.
    """
    settings: list[Ready] = []
    for family, folder in described.items():
        members = family_settings(family, parameters)
        found = _read_described(Path(folder), members)
        made = [make_ready(setting, found, parameters) for setting in members]
        settings += [ready for ready in made if isinstance(ready, Ready)]
    if not settings:
        raise RecognitionError("No setting can be run, so there is none to time.")
    table = measure_seconds(_surfaces(meshes), settings, parameters.cost.rounds)
    write_table(COST_SECONDS, table, output)


def make_cost(
    errors: Sequence[str | Path],
    seconds: str | Path,
    output: str | Path,
    metrics: str | Path,
) -> None:
    """Join error rates and seconds, mark the front, and write the error rates for machines.

    Parameters
    ----------
    errors : sequence of path
        `tables.COST_ERRORS` of all families.
    seconds : path
        `tables.COST_SECONDS`.
    output : path
        The Parquet file to write.
    metrics : path
        JSON file of error rates by family and setting. It holds no seconds: the same tables
        give the same bytes.
    """
    measured = read_table(COST_ERRORS, errors)
    write_table(COST, join_costs(measured, read_table(COST_SECONDS, seconds)), output)
    figures: dict[str, dict[str, Any]] = {}
    for row in read_costs(output):
        figures.setdefault(row["family"], {})[row["setting"]] = {
            name: row[name] for name in FIGURES
        }
    text = json.dumps(round_numbers(figures), indent=2, ensure_ascii=False) + "\n"
    Path(metrics).parent.mkdir(parents=True, exist_ok=True)
    Path(metrics).write_text(text, encoding="utf-8")


def _surfaces(meshes: Sequence[str | Path]) -> dict[str, Surface]:
    return {f"{Path(mesh).parent.name}/{Path(mesh).stem}": read_surface(mesh) for mesh in meshes}


def _run_tables(fixations: Sequence[str | Path], features: Sequence[str | Path]) -> RunTables:
    tables = [
        select(read_table(schema, paths), strategy=STRATEGY)
        for schema, paths in ((FIXATIONS, fixations), (FEATURES, features))
    ]
    if not tables[1].num_rows:
        raise RecognitionError(
            f"no touch was made by {STRATEGY}, which is what costs are measured for; name it in "
            f"probing.strategies."
        )
    return RunTables(*tables)


def _read_described(folder: Path, settings: Sequence[Setting]) -> dict[Changes, pa.Table | str]:
    """Give what lies in a family's folder in the way in which `setting_features` gives it."""
    found: dict[Changes, pa.Table | str] = {}
    for condition in dict.fromkeys(condition_of(setting) for setting in settings):
        place = len(found)
        file = folder / f"{place}.parquet"
        found[condition] = (
            read_table(FEATURES, file)
            if file.exists()
            else (folder / f"{place}.txt").read_text(encoding="utf-8")
        )
    return found
