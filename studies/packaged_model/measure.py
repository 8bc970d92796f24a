"""Fit the package's model by a written rule, and measure its answers: ``python -m packaged_model.measure FEATURES``.

`FEATURES` is the folder results/features of a finished run of set ``all``. The rule, written before any score was
computed:

1. Objects: set ``all`` without its seven test classes, without the four examples of the package, and without classes that
   then have fewer than five objects. Touches are by fixation, as in a default run: 16 views, five touches each.
2. Known of the pose: ``vertical``. A stranger's mesh stands upright or is told its up axis; which way it faces is not known.
3. Pipeline: `order_free` or `learned`, each with its headline classifier. Both are fitted five times, each time without a
   fifth of the objects, and answer for these. `learned` is taken if it names more objects right from 16 views, with p below
   0.05 by sign changes over objects, if a fit takes less than 300 processor seconds and if the file is smaller than 10 MB;
   else `order_free`.
4. Reported: the share of held-out objects that are named right from 16 views and from one, per class; how often the
   prediction set of 90 % holds the class; how many objects of the seven test classes are called ``unknown`` by the five
   models, and how many of the held-out objects are by mistake.

Nothing else is chosen.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.compute as pc
from joblib import Parallel, delayed
from sklearn.model_selection import StratifiedKFold
from tqdm import tqdm

from learned.study import PIPELINES
from visuohaptic.evaluation.intervals import SIGNIFICANCE, PairedComparison, compare_paired
from visuohaptic.exploration.examples import examples
from visuohaptic.exploration.recognising import PACKAGED_MODEL
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.model import RecognitionModel, fit_model
from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters
from visuohaptic.recognition.stored_models import save_model
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

LEAST_OBJECTS = 5
"""The smallest number of objects of an admitted class."""
FOLDS = 5
SEED = 2018
LONGEST_FIT_S = 300.0
LARGEST_BYTES = 10_000_000
PARAMETERS = RecognitionParameters(frame="vertical")
CHOSEN = Path(__file__).with_name("chosen.json")
"""The chosen pipeline, and processor seconds and bytes of both models."""

Owner = tuple[str, str]
"""Class and name of an object."""


def admitted(owners: list[Owner]) -> list[Owner]:
    """Return the objects that the rule admits, sorted: no test class, no example, no class of few objects."""
    held_out = {
        (path.parent.name, path.name.removesuffix(".ply.gz")) for path in examples().values()
    }
    left = sorted(
        owner for owner in owners if owner[0] not in TEST_CLASSES and owner not in held_out
    )
    counts = Counter(category for category, _ in left)
    return [owner for owner in left if counts[owner[0]] >= LEAST_OBJECTS]


def by_object(features: pa.Table) -> dict[Owner, pa.Table]:
    """Return the rows of each object."""
    names = pc.binary_join_element_wise(features["class"], features["object"], "/")
    return {
        tuple(name.split("/")): features.filter(pc.equal(names, name))
        for name in sorted(names.unique().to_pylist())
    }


def fit(rows: list[pa.Table], pipeline: str) -> RecognitionModel:
    """Fit a model of a pipeline on the rows of objects."""
    return fit_model(
        pa.concat_tables(rows), pipeline, HEADLINE_CLASSIFIERS[pipeline], PARAMETERS, SEED
    )


def answers(model: RecognitionModel, objects: dict[Owner, pa.Table]) -> Iterator[dict[str, Any]]:
    """Yield what a model answers for each object from all views: its likeliest class, ``named``, and the prediction set.

    ``views`` is the share of single views from which the model names the object right, in [0, 1].
    """
    for (category, name), rows in objects.items():
        answer = model.answer(rows)
        views = [
            next(iter(model.recognise(rows.filter(pc.equal(rows["viewpoint"], view)))))
            for view in rows["viewpoint"].unique().to_pylist()
        ]
        yield {
            "class": category,
            "object": name,
            "named": next(iter(answer.probabilities)),
            "candidates": list(answer.candidates or ()),
            "unknown": answer.unknown,
            "novelty_rank": answer.novelty_rank,
            "views": float(np.mean([one == category for one in views])),
        }


def measure(objects: dict[Owner, pa.Table], pipeline: str) -> pd.DataFrame:
    """Answer for each admitted object by a model that did not learn it, and for objects of the test classes.

    Returns one row per answer, with the columns of `answers`, ``fold`` and ``pipeline``. Objects of the test classes have
    one row per model.
    """
    known = admitted(list(objects))
    strange = {owner: rows for owner, rows in objects.items() if owner[0] in TEST_CLASSES}
    folds = StratifiedKFold(FOLDS, shuffle=True, random_state=SEED)
    found = []
    divided = list(folds.split(known, [one[0] for one in known]))
    for fold, (train, test) in enumerate(tqdm(divided, desc=pipeline, unit="model")):
        model = fit([objects[known[index]] for index in train], pipeline)
        asked = {known[index]: objects[known[index]] for index in test} | strange
        found += [{"fold": fold, "pipeline": pipeline, **row} for row in answers(model, asked)]
    return pd.DataFrame(found)


def gain_of(measured: pd.DataFrame) -> PairedComparison:
    """Compare the share of held-out objects that pipeline `learned` names right with that of `order_free`, in pairs."""
    known = measured[~measured["class"].isin(TEST_CLASSES)]
    right = known.assign(right=(known["named"] == known["class"]).astype(float)).pivot(
        index=["class", "object"], columns="pipeline", values="right"
    )
    categories = tuple(right.index.get_level_values("class"))
    learned, order_free = (right[name].to_numpy() for name in ("learned", "order_free"))
    return compare_paired(
        learned, order_free, np.ones(len(right)), IntervalParameters(), categories
    )


def chosen_pipeline(measured: pd.DataFrame, seconds: float, size: int) -> str:
    """Apply the rule; `seconds` and `size` are processor seconds and bytes of the model of `learned`."""
    gain = gain_of(measured)
    is_better = gain.difference.mean > 0 and gain.p_value < SIGNIFICANCE
    is_taken = is_better and seconds < LONGEST_FIT_S and size < LARGEST_BYTES
    return "learned" if is_taken else "order_free"


def main() -> None:
    """Measure both pipelines, choose one by the rule, and write the package's model and the answers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("features", type=Path, help="results/features of a run of set all")
    parser.add_argument("--output", type=Path, default=Path("results/packaged_model.parquet"))
    arguments = parser.parse_args()
    table = read_table(FEATURES, sorted(arguments.features.rglob("*.parquet")))
    objects = by_object(table.filter(pc.equal(table["strategy"], "fixation")))
    both = Parallel(n_jobs=2)(delayed(measure)(objects, pipeline) for pipeline in PIPELINES)
    measured = pd.concat(both, ignore_index=True)
    measured.to_parquet(arguments.output, index=False)
    learnt = [objects[owner] for owner in admitted(list(objects))]
    made: dict[str, dict[str, float]] = {}
    touching = json.dumps(
        ExperimentParameters(meshes={"set": "all"}).model_dump(
            mode="json", exclude={"workflow", "recognition", "cost"}
        )
    )
    for pipeline in PIPELINES:
        start = time.process_time()
        model = replace(fit(learnt, pipeline), touching=touching)
        seconds = time.process_time() - start
        path = arguments.output.with_name(f"{pipeline}.skops")
        save_model(model, path)
        made[pipeline] = {"seconds": seconds, "bytes": path.stat().st_size}
    chosen = chosen_pipeline(measured, made["learned"]["seconds"], int(made["learned"]["bytes"]))
    CHOSEN.write_text(
        json.dumps({"chosen": chosen, "models": made}, indent=2) + "\n", encoding="utf-8"
    )
    arguments.output.with_name(f"{chosen}.skops").replace(PACKAGED_MODEL)
    for pipeline in PIPELINES:
        arguments.output.with_name(f"{pipeline}.skops").unlink(missing_ok=True)


if __name__ == "__main__":
    main()
