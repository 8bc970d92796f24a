"""Recompute features that conditions of a study share and the run does not have.

This module must not import classifiers, so that a job that only touches does not load scikit-learn.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import PolicyError
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import object_of
from visuohaptic.geometry.turning import draw_rotation
from visuohaptic.io.phase_files import SCHEMAS, Tables, objects_of
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import inputs_needed_from
from visuohaptic.pipeline import run
from visuohaptic.studies.conditions import Recomputation
from visuohaptic.studies.refusals import ERROR, REFUSALS, REFUSED_POLICIES
from visuohaptic.tables.phases import FEATURES, of_objects
from visuohaptic.tables.schema import join_parts, read_table, write_table

Paths = Sequence[str | Path]

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Sources:
    """Files of the run from which features are recomputed.

    Attributes
    ----------
    meshes : sequence of paths
        Mesh files; all of them are used.
    tables : mapping of str to sequence of paths
        Parts of tables by name.
    objects : collection of str, optional
        Objects, ``class/name``, to take from the tables. The default is all objects.
    """

    meshes: Paths = ()
    tables: Mapping[str, Paths] = field(default_factory=dict)
    objects: Collection[str] | None = None

    def files_for(self, phase: str) -> list[dict[str, Paths]]:
        """Return groups of files by table, each to be read at once, for a recomputation from `phase` on.

        If only a table of imprints is needed, each part is a group, because imprints are large.
        """
        needed = inputs_needed_from(phase)
        tables = {name: self.tables[name] for name in needed if name != "meshes"}
        if "meshes" in needed or len(tables) > 1:
            return [tables]
        return [{name: [part]} for name, parts in tables.items() for part in parts]


def make_study_features(recomputation: Recomputation, sources: Sources, output: str | Path) -> None:
    """Write recomputed features, or an empty table with the error message in its metadata."""
    try:
        table = recompute_features(recomputation, sources)
    except REFUSALS as refusal:
        table = FEATURES.arrow.empty_table().replace_schema_metadata({ERROR: str(refusal)})
    write_table(FEATURES, table, output)


def recompute_features(recomputation: Recomputation, sources: Sources) -> pa.Table:
    """Recompute `tables.FEATURES` of the strategies in the parameters.

    The meshes of the files are turned by `parameters.meshes.turns`. A policy that fails on an object has no rows, and
    its error is in the metadata (`REFUSED_POLICIES`). Raises `PolicyError` if no other strategy is left.
    """
    refused: dict[str, str] = {}
    parameters = recomputation.parameters
    meshes = {object_of(mesh): mesh for mesh in sources.meshes}
    parts = [FEATURES.arrow.empty_table()]
    for files_by_table in sources.files_for(recomputation.phase):
        tables = {
            name: _of_strategies(
                of_objects(read_table(SCHEMAS[name], files), sources.objects),
                parameters.probing.strategies,
            )
            for name, files in files_by_table.items()
        }
        for key, known in objects_of(tables, meshes):
            viewpoints = range(parameters.viewpoints.total)
            subject = Subject.of_mesh(
                key, meshes.get(key, ""), viewpoints, _rotation(key, parameters)
            )
            parts.append(_features_of(subject, parameters, known, refused))
    features = join_parts(FEATURES, parts)
    if not refused:
        return features
    kept = _of_strategies(features, set(parameters.probing.strategies) - set(refused))
    return kept.replace_schema_metadata({REFUSED_POLICIES: json.dumps(refused)})


def _features_of(
    subject: Subject, parameters: ExperimentParameters, known: Tables, refused: dict[str, str]
) -> pa.Table:
    """Run the phases of an object without the refused policies; write the error of each policy that fails to `refused`."""
    strategies = [name for name in parameters.probing.strategies if name not in refused]
    if not strategies:
        raise PolicyError(" ".join(refused.values()))
    probing = parameters.probing.model_copy(update={"strategies": tuple(strategies)})
    try:
        tables = run(subject, parameters.model_copy(update={"probing": probing}), known)
    except PolicyError as error:
        if error.policy not in strategies:
            raise
        logger.warning("%s", error)
        refused[error.policy] = str(error)
        return _features_of(subject, parameters, known, refused)
    return tables["features"]


def _rotation(key: str, parameters: ExperimentParameters) -> FloatArray | None:
    """Draw the rotation of an object; None if objects are not turned."""
    turns = parameters.meshes.turns
    if turns == "none":
        return None
    return draw_rotation(turns, key, parameters.seed, parameters.meshes.turn_draw)


def _of_strategies(table: pa.Table, strategies: Iterable[str]) -> pa.Table:
    chosen = pa.array(list(strategies))
    return table.filter(pc.is_in(table.column("strategy"), chosen)).combine_chunks()
