"""Measure both pipelines on set ``all`` by the known part of the pose: ``python -m learned.all_classes FEATURES``.

`FEATURES` is the folder results/features of a run of set ``all`` by the strategies of study `learned`. Measured are the
objects of the package's model, of 20 classes, if a view has five touches. Each object is tested once, from one view, by a
model that did not learn the object. 67 of these objects chose the settings of both pipelines. No question was written down
before the figures were computed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from tqdm import tqdm

from learned.curves import accuracies
from learned.study import FRAMES, PIPELINES, STRATEGIES
from packaged_model.measure import admitted, by_object
from visuohaptic.evaluation.intervals import compare_paired, plain_comparison
from visuohaptic.evaluation.leads import LEADS
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Row, measured
from visuohaptic.report.leads import Lead
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

MEASURED = Path(__file__).with_name("all_classes.json")


def admitted_rows(features: pa.Table) -> pa.Table:
    """Return the rows by the study's strategies of the objects that the package's model learns."""
    objects = by_object(features.filter(pc.is_in(features["strategy"], pa.array(STRATEGIES))))
    return pa.concat_tables([objects[owner] for owner in admitted(list(objects))])


def measure(features: pa.Table) -> dict[str, list[dict[str, Any]]]:
    """Compute accuracies, gains of `learned` over `order_free` and the leads of places over others, a row each."""
    settings = [*product(FRAMES, STRATEGIES, PIPELINES)]
    shares = {
        setting: dict(accuracies(features, strategy, frame, pipeline))
        for setting in tqdm(settings, unit="setting")
        for frame, strategy, pipeline in [setting]
    }
    before, after = PIPELINES
    return {
        "accuracies": [
            {
                "frame": frame,
                "strategy": strategy,
                "pipeline": pipeline,
                "objects": len(own),
                "accuracy": float(np.mean([*own.values()])),
            }
            for (frame, strategy, pipeline), own in shares.items()
        ],
        "gains": [
            {"frame": frame, "strategy": strategy}
            | compare(shares[frame, strategy, after], shares[frame, strategy, before])
            for frame, strategy in product(FRAMES, STRATEGIES)
        ],
        "leads": [
            {"frame": frame, "pipeline": pipeline, "lead": name}
            | compare(*(shares[frame, strategy, pipeline] for strategy in strategies))
            for frame, pipeline in product(FRAMES, PIPELINES)
            for name, strategies in LEADS.items()
        ],
    }


def compare(first: Mapping[str, float], second: Mapping[str, float]) -> dict[str, Any]:
    """Compare the accuracies of the objects, ``class/name``, that are in both."""
    objects = sorted({*first} & {*second})
    values, others = (np.array([found[key] for key in objects]) for found in (first, second))
    classes = [key.split("/")[0] for key in objects]
    return plain_comparison(
        compare_paired(values, others, np.ones(len(objects)), IntervalParameters(), classes)
    )


def leads_of(rows: Sequence[Row]) -> tuple[Lead, ...]:
    """Return measured leads, rows of `measure`, in the form of the report."""
    return tuple(
        Lead(
            row["lead"],
            row["pipeline"],
            "none",
            row["frame"],
            1,
            row["objects"],
            measured(row, "difference"),
        )
        for row in rows
    )


def main() -> None:
    """Write accuracies, gains and leads as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("features", type=Path, help="results/features of a run of set all")
    arguments = parser.parse_args()
    features = read_table(FEATURES, sorted(arguments.features.rglob("*.parquet")))
    with one_thread():
        found = measure(admitted_rows(features))
    MEASURED.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
