"""From the study's tables and the run's meshes to the cost tables, file to file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow as pa

from visuohaptic.errors import RecognitionError
from visuohaptic.geometry.surface import read_surface, usable_meshes
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.cost.front import error_rows, join_costs
from visuohaptic.studies.cost.seconds import FittedSetting, fit_setting, measure_seconds
from visuohaptic.studies.cost.settings import cost_study, make_settings
from visuohaptic.studies.figures import read_cells
from visuohaptic.studies.files import read_study_features
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import COST, COST_SECONDS

Paths = Sequence[str | Path]


def make_cost_seconds(
    meshes: Paths,
    features: Paths,
    made: Mapping[str, str | Path],
    output: str | Path,
    run: ExperimentParameters,
) -> None:
    """Time every setting of every family side by side: `tables.COST_SECONDS`.

    `made` has features of the study's conditions by key; those of the run are `features`.
    """
    held: dict[str | None, pa.Table | str] = {None: read_table(FEATURES, features)}
    settings: list[FittedSetting] = []
    planned = plan_study(cost_study(run), run).conditions
    for setting, one in zip(make_settings(run), planned, strict=True):
        if one.key is not None and one.key not in held:
            held[one.key] = read_study_features(made[one.key])
        fitted = fit_setting(setting, one, held[one.key], run.seed)
        settings += [fitted] if isinstance(fitted, FittedSetting) else []
    if not settings:
        raise RecognitionError("No setting can be run, so there is none to time.")
    surfaces = {
        f"{mesh.parent.name}/{mesh.stem}": read_surface(mesh) for mesh in usable_meshes(meshes)
    }
    table = measure_seconds(surfaces, settings, run.cost.rounds)
    write_table(COST_SECONDS, table, output)


def make_cost(
    parts: Paths, seconds: str | Path, output: str | Path, run: ExperimentParameters
) -> None:
    """Join error rates, from `tables.STUDY`, and seconds, and mark the front: `tables.COST`."""
    errors = error_rows(read_cells(parts), run)
    table = join_costs(errors, read_table(COST_SECONDS, seconds))
    write_table(COST, table, output)
