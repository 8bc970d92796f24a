"""From the predictions of a run and their sums to the table of all its guards."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

from visuohaptic.guards.p_values import guard_signs
from visuohaptic.guards.sums import guard_sums
from visuohaptic.guards.verdicts import table_of
from visuohaptic.seeds import spawn_generator
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.phases import PREDICTIONS
from visuohaptic.tables.schema import read_table, write_table


def make_guards(
    training: str | Path,
    predictions: Sequence[str | Path],
    metrics: str | Path,
    output: str | Path,
    seed: int,
) -> None:
    """Try the guards of the figures, and write them after those of `make_training_guards`; one that fails raises nothing here."""
    predicted = read_table(PREDICTIONS, predictions)
    published = json.loads(Path(metrics).read_text(encoding="utf-8"))
    counted = predicted.group_by(["class", "object"]).aggregate([([], "count_all")])
    weights = counted.column("count_all").to_numpy().astype(np.float64)
    verdicts = [
        guard_sums(published, predicted),
        guard_signs(weights, spawn_generator(seed, "guards", "figures")),
    ]
    table = pa.concat_tables([read_table(GUARDS, training), table_of(verdicts)])
    write_table(GUARDS, table, output)
