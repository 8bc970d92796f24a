"""From the tables of a run to its guards of training and of random places, which need no predictions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.errors import RecognitionError
from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.geometry.surface import read_surface, set_aside_reason
from visuohaptic.guards.areas import coordinates, guard_areas
from visuohaptic.guards.leaks import guard_chance, guard_unseen, sample_objects
from visuohaptic.guards.verdicts import Verdict, table_of
from visuohaptic.recognition.experiment import gather_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.seeds import spawn_generator
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.phases import FEATURES, FIXATIONS, POINT_NAMES
from visuohaptic.tables.schema import matrix, read_table, write_table

UNIFORM_STRATEGIES = tuple(entry.name for entry in STRATEGIES if entry.uniform)
"""Strategies whose places, in reach or not, are drawn by area; both have the same draws."""

MESHES = 12
"""Objects whose random places are tested."""

Paths = Sequence[str | Path]


def make_training_guards(
    features: Paths,
    fixations: Paths,
    meshes: Mapping[str, Path],
    output: str | Path,
    pipelines: Sequence[str],
    recognition: RecognitionParameters,
    seed: int,
) -> None:
    """Try the guards of training and of random places, and write their table; one that fails raises nothing here."""
    generator = spawn_generator(seed, "guards")
    verdicts = [
        *_guard_training(read_table(FEATURES, features), pipelines, recognition, seed, generator),
        guard_areas(list(_random_places(fixations, meshes, generator))),
    ]
    write_table(GUARDS, table_of(verdicts), output)


def _guard_training(
    features: pa.Table,
    pipelines: Sequence[str],
    recognition: RecognitionParameters,
    seed: int,
    generator: np.random.Generator,
) -> Iterator[Verdict]:
    strategy = features.column("strategy")[0].as_py()
    table, _ = take_strategy(features, strategy, recognition.touches)
    sampled = sample_objects(table, generator)
    try:
        sequences = gather_pipeline(sampled, recognition, "paper", seed)
        yield guard_chance(sequences, recognition, generator)
        for pipeline in pipelines:
            yield guard_unseen(sampled, pipeline, recognition, seed, generator)
    except RecognitionError as error:
        yield Verdict("test objects and training", "not tested", str(error))


def _random_places(
    fixations: Paths, meshes: Mapping[str, Path], generator: np.random.Generator
) -> Iterator[np.ndarray[tuple[int, ...], np.dtype[np.float64]]]:
    """Give the coordinates of the random places of some objects, those passed over among them."""
    located = read_table(FIXATIONS, fixations)
    drawn = set(pc.unique(located.column("strategy")).to_pylist())
    strategy = next((name for name in UNIFORM_STRATEGIES if name in drawn), None)
    usable = sorted(key for key, path in meshes.items() if set_aside_reason(path) is None)
    for place in generator.permutation(len(usable))[: MESHES if strategy else 0]:
        category, name = usable[place].split("/")
        chosen = located.filter(
            (pc.field("class") == category)
            & (pc.field("object") == name)
            & (pc.field("strategy") == strategy)
        )
        faces = chosen.column("face").to_numpy().astype(np.int64)
        surface = read_surface(meshes[usable[place]])
        yield coordinates(surface, matrix(chosen, POINT_NAMES), faces)
