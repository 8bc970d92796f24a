"""From a run's tables to the tables of a study, file to file."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import Planned, Recomputation, with_changes
from visuohaptic.studies.measuring import (
    REFUSALS,
    Memory,
    Sources,
    measure_condition,
    recompute_features,
)
from visuohaptic.studies.study import Condition
from visuohaptic.tables.phases import FEATURES, of_objects
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import STUDY

_ERROR = b"error"


def make_study_features(recomputation: Recomputation, sources: Sources, output: str | Path) -> None:
    """Write features that conditions share; where they are refused, an empty table with the reason."""
    try:
        table = recompute_features(recomputation, sources)
    except REFUSALS as refusal:
        table = FEATURES.arrow.empty_table().replace_schema_metadata({_ERROR: str(refusal)})
    write_table(FEATURES, table, output)


def read_study_features(path: str | Path) -> pa.Table | str:
    """Read what `make_study_features` wrote: features, or the sentence by which they were refused."""
    error = (pq.read_schema(path).metadata or {}).get(_ERROR)
    return read_table(FEATURES, path) if error is None else error.decode("utf-8")


def make_study_block(
    study: str,
    conditions: Sequence[Mapping[str, Any]],
    features: Sequence[str | Path],
    made: Mapping[str, str | Path],
    output: str | Path,
    run: ExperimentParameters,
    objects: Collection[str] | None = None,
) -> None:
    """Measure a block of a study's conditions: `tables.STUDY`.

    `conditions` are as `describe_conditions` gives them. `features` are the run's own, empty where
    every condition has others; `made` has these by key. `objects`, `class/name`, are those of the
    run's features that count; all without it.
    """
    memory, of_key = Memory(), features_by_key(features, made, objects)
    parts: list[pa.Table] = []
    for row in conditions:
        condition = Condition(row["name"], row["changes"], votes=row["votes"])
        planned = Planned(condition, with_changes(run, condition.changes), row["key"])
        parts += measure_condition(study, planned, of_key(row["key"]), run.seed, memory)
    write_table(STUDY, pa.concat_tables(parts), output)


def features_by_key(
    features: Sequence[str | Path], made: Mapping[str, str | Path], objects: Collection[str] | None
) -> Callable[[str | None], pa.Table | str]:
    """Read features as conditions name them: those of the run (None), or made for some conditions.

    One table is held at a time: conditions with the same features are neighbours. `objects` are
    those of the run's features that count; all without it.
    """

    @lru_cache(maxsize=1)
    def read(key: str | None) -> pa.Table | str:
        if key is None:
            return of_objects(read_table(FEATURES, features), objects)
        return read_study_features(made[key])

    return read
