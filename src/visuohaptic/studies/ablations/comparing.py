"""All ablations side by side, each compared with the whole method over the same objects."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.intervals import compare_paired, object_interval
from visuohaptic.recognition.metrics import round_numbers
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.ablations.settings import ABLATIONS, WHOLE
from visuohaptic.tables.schema import (
    build_table,
    matrix,
    read_table,
    write_table,
)
from visuohaptic.tables.studies import ABLATION
from visuohaptic.tables.studies import ABLATIONS as ABLATIONS_SCHEMA

FIGURES = ("accuracy", "low", "high", "loss", "loss_low", "loss_high", "p_value", "objects")

Objects = list[tuple[str, str]]


def compare_ablations(parts: pa.Table, intervals: IntervalParameters, seed: int) -> pa.Table:
    """Compare ablations with the whole method.

    Parameters
    ----------
    parts : pyarrow.Table
        `tables.ABLATION` of any ablations, the whole method among them.
    intervals : IntervalParameters
        Resampling over objects.
    seed : int
        The experiment's seed.

    Returns
    -------
    pyarrow.Table
        `tables.ABLATIONS`, in the order of `settings.ABLATIONS`.

    Raises
    ------
    RecognitionError
        If the whole method is missing, or was tested on other objects.
    """
    found = _by_key(parts)
    rows: list[dict[str, Any]] = []
    places = {name: place for place, name in enumerate(ABLATIONS)}
    for key in sorted(found, key=lambda key: (key[1], places[key[0]])):
        name, pipeline, classifier = key
        objects, values = found[key]
        whole = found.get((WHOLE.name, pipeline, classifier))
        if whole is None or whole[0] != objects:
            raise RecognitionError(
                f"Ablation {name}, pipeline {pipeline}, has no {WHOLE.name} on the same "
                f"{len(objects)} objects to be compared with; make both again."
            )
        weights = values[:, 1]
        # The same draws of objects for every row, so that equal rows have equal intervals.
        generator = spawn_generator(seed, "ablations", pipeline, classifier)
        mean = object_interval(values[:, 0], weights, intervals, generator)
        compared = compare_paired(whole[1][:, 0], values[:, 0], weights, intervals, generator)
        rows.append(
            {
                "ablation": name,
                "pipeline": pipeline,
                "classifier": classifier,
                "group": ABLATIONS[name].group,
                "remade": ABLATIONS[name].remade,
                "accuracy": mean.mean,
                "low": mean.low,
                "high": mean.high,
                "loss": compared.difference.mean,
                "loss_low": compared.difference.low,
                "loss_high": compared.difference.high,
                "p_value": compared.p_value,
                "making_seconds": float(values[0, 2]),
                "naming_seconds": float(values[0, 3]),
                "objects": len(objects),
            }
        )
    return build_table(ABLATIONS_SCHEMA, {name: [row[name] for row in rows] for name in rows[0]})


def make_ablations(
    parts: Sequence[str | Path],
    output: str | Path,
    metrics: str | Path,
    intervals: IntervalParameters,
    seed: int,
) -> None:
    """Make the table of all ablations, and a JSON file beside the metrics.

    Parameters
    ----------
    parts : sequence of path
        One `tables.ABLATION` an ablation.
    output : path
        The Parquet file to write.
    metrics : path
        JSON file of the figures by pipeline, classifier and ablation. It holds no seconds: the
        same tables give the same bytes.
    intervals : IntervalParameters
        Resampling over objects.
    seed : int
        The experiment's seed.
    """
    table = compare_ablations(read_table(ABLATION, parts), intervals, seed)
    write_table(ABLATIONS_SCHEMA, table, output)
    figures: dict[str, dict[str, dict[str, Any]]] = {}
    for row in table.to_pylist():
        of_classifier = figures.setdefault(row["pipeline"], {}).setdefault(row["classifier"], {})
        of_classifier[row["ablation"]] = {name: row[name] for name in FIGURES}
    text = json.dumps(round_numbers(figures), indent=2) + "\n"
    Path(metrics).parent.mkdir(parents=True, exist_ok=True)
    Path(metrics).write_text(text, encoding="utf-8")


def _by_key(
    parts: pa.Table,
) -> dict[tuple[str, str, str], tuple[Objects, NDArray[np.float64]]]:
    keys = ["ablation", "pipeline", "classifier", "class", "object"]
    parts = parts.sort_by([(key, "ascending") for key in keys])
    figures = matrix(parts, ["accuracy", "weight", "making_seconds", "naming_seconds"])
    names = zip(*(parts.column(key).to_pylist() for key in keys), strict=True)
    found: dict[tuple[str, str, str], tuple[Objects, list[NDArray[np.float64]]]] = {}
    for (ablation, pipeline, classifier, *owner), row in zip(names, figures, strict=True):
        objects, rows = found.setdefault((ablation, pipeline, classifier), ([], []))
        objects.append((owner[0], owner[1]))
        rows.append(row)
    return {key: (objects, np.stack(rows)) for key, (objects, rows) in found.items()}
