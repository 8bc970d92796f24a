"""From the study's tables and the run's meshes to the cost tables, file to file."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pyarrow as pa

from visuohaptic.geometry.surface import object_of, read_surface, usable_meshes
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.cost.front import weigh
from visuohaptic.studies.cost.seconds import FittedSetting, fit_setting, measure_seconds
from visuohaptic.studies.cost.settings import make_settings, make_study
from visuohaptic.studies.figures import read_cells
from visuohaptic.studies.files import read_study_features
from visuohaptic.tables.phases import FEATURES, of_objects
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import COST, COST_SECONDS

Paths = Sequence[str | Path]

ROUNDS = {"frontier": 2}
"""Rounds of timing where they are not `cost.rounds`: the frontier is a part of every run."""


def make_cost_seconds(
    study: str,
    meshes: Paths,
    features: Paths,
    made: Mapping[str, str | Path],
    output: str | Path,
    run: ExperimentParameters,
    objects: Collection[str] | None = None,
) -> None:
    """Time every setting of every family side by side: `tables.COST_SECONDS`.

    Parameters
    ----------
    study : {"frontier", "cost"}
        Whose settings.
    meshes : sequence of path
        Surfaces of the objects on which time is taken.
    features : sequence of path
        The run's own features.
    made : mapping of str to path
        Features of the study's conditions, by key.
    output : path
        The Parquet file to write.
    run : ExperimentParameters
        The run's.
    objects : collection of str, optional
        Objects, `class/name`, whose features count; all without it.
    """
    held: dict[str | None, pa.Table | str] = {
        None: of_objects(read_table(FEATURES, features), objects)
    }
    settings: list[FittedSetting] = []
    # What differs in the number of viewpoints alone is named by one model.
    trained: dict[Hashable, FittedSetting | str] = {}
    planned = plan_study(make_study(study, run), run).conditions
    for setting, one in zip(make_settings(run, study), planned, strict=True):
        if one.key is not None and one.key not in held:
            held[one.key] = read_study_features(made[one.key])
        named = (setting.strategy, setting.pipeline, setting.classifier)
        asked = (one.key, one.parameters.model_dump_json(), *named)
        if asked not in trained:
            trained[asked] = fit_setting(setting, one, held[one.key], run.seed)
        fitted = trained[asked]
        if isinstance(fitted, FittedSetting):
            settings.append(replace(fitted, setting=setting))
    surfaces = {object_of(mesh): read_surface(mesh) for mesh in usable_meshes(meshes)}
    table = measure_seconds(surfaces, settings, ROUNDS.get(study, run.cost.rounds))
    write_table(COST_SECONDS, table, output)


def make_cost(
    study: str, parts: Paths, seconds: str | Path, output: str | Path, run: ExperimentParameters
) -> None:
    """Join error rates and seconds, and mark the front.

    Parameters
    ----------
    study : {"frontier", "cost"}
        Whose settings.
    parts : sequence of path
        `tables.STUDY` of all settings.
    seconds : path
        `tables.COST_SECONDS`.
    output : path
        The Parquet file to write.
    run : ExperimentParameters
        The run's.
    """
    table = weigh(read_cells(parts), read_table(COST_SECONDS, seconds), run, study)
    write_table(COST, table, output)
