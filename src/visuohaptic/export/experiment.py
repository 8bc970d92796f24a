"""The experiment behind a data set: features, divisions of objects, parameters, and what they gave."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic import __version__
from visuohaptic.errors import ExportError
from visuohaptic.tables.phases import FEATURES, PREDICTIONS, keys_of
from visuohaptic.tables.schema import read_table


@dataclass(frozen=True, eq=False)
class Experiment:
    """What others need to compare with the experiment.

    `features` are `tables.FEATURES` of all touches; `tested` gives for each division of the objects
    those that tested, `class/name`; `baselines` say how often each classifier was right.
    """

    features: pa.Table
    tested: Sequence[Sequence[str]]
    parameters: Mapping[str, Any]
    baselines: Sequence[Mapping[str, Any]]
    commit: str

    def as_json(self) -> str:
        """Give all but the features as JSON text."""
        held = {
            "version": __version__,
            "commit": self.commit,
            "parameters": self.parameters,
            "tested_objects": self.tested,
            "baselines": self.baselines,
        }
        return json.dumps(held, indent=1, ensure_ascii=False) + "\n"


def read_experiment(
    features: Sequence[str | Path],
    predictions: Sequence[str | Path],
    metrics: str | Path,
    parameters: Mapping[str, Any],
    commit: str,
) -> Experiment:
    """Read a finished run's experiment from its files.

    Raises `ExportError` if its metrics are missing, and `TableError` if a table breaks its schema.
    """
    try:
        results = json.loads(Path(metrics).read_text(encoding="utf-8"))["results"]
    except (OSError, ValueError, KeyError):
        raise ExportError(f"{metrics} is no metrics of a run; run `snakemake -j2` first.") from None
    tested = _tested_objects(read_table(PREDICTIONS, predictions))
    baselines = [
        {"pipeline": pipeline, "strategy": strategy, "classifier": classifier}
        | {"accuracy": found["accuracy"]["mean"]}
        | {end: found["accuracy"][end] for end in ("low", "high")}
        for pipeline, strategies in results.items()
        for strategy, classifiers in strategies.items()
        for classifier, found in classifiers.items()
    ]
    return Experiment(read_table(FEATURES, features), tested, parameters, baselines, commit)


def _tested_objects(predictions: pa.Table) -> list[list[str]]:
    tested: dict[int, set[str]] = {}
    splits = predictions.column("split").to_pylist()
    for split, key in zip(splits, keys_of(predictions).to_pylist(), strict=True):
        tested.setdefault(split, set()).add(key)
    return [sorted(tested[split]) for split in sorted(tested)]
