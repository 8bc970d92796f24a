"""How models hold for touches by strategies that they did not learn from: `python -m benchmarks.other_strategies`.

Each of the paper's twelve objects is classified by models of the other eleven. Certainty of touches by other strategies
is computed as if the model had learnt from them, which `RecognitionModel.answer` refuses. Docs: docs/certainty.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

import visuohaptic as vh
from visuohaptic.evaluation.intervals import object_interval
from visuohaptic.recognition.model import RecognitionModel, fit_model
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.voting import evenly_spaced_subsets
from visuohaptic.tables.phases import FEATURES, owners_of
from visuohaptic.tables.schema import join_parts

if TYPE_CHECKING:
    from visuohaptic.base.arrays import FloatArray

MESHES = Path("meshes/paper")
STRATEGIES = ("fixation", "random", "farthest_point", "seek_relief", "curvature", "contour")
LEARNT = (("fixation",), ("random",), ("fixation", "random"))
VIEWS = (1, 16)
FIGURES = ("correct", "stated", "sets hold", "more novel than 90 %")


def touch_all(strategies: Sequence[str]) -> dict[str, pa.Table]:
    """Touch all objects by each strategy: rows of `tables.FEATURES` by strategy."""
    objects = [vh.load(path) for path in sorted(MESHES.glob("*/*.ply.gz"))]
    return {
        name: join_parts(FEATURES, [one.touch(strategy=name).features for one in objects])
        for name in strategies
    }


def as_if_learnt(model: RecognitionModel, strategy: str) -> RecognitionModel:
    """Return a model that compares touches by a strategy with touches by its first strategy, unless it learnt both."""
    if model.matching_strategy(strategy) is not None:
        return model
    return replace(
        model,
        strategies=(strategy,),
        certainties={strategy: next(iter(model.certainties.values()))},
    )


def answers(model: RecognitionModel, touches: pa.Table, views: int) -> Iterator[tuple[float, ...]]:
    """Yield `FIGURES` of each evenly spaced choice of the views of one object."""
    (category,) = touches.column("class").unique().to_pylist()
    viewpoint = touches.column("viewpoint").to_numpy()
    seen = np.unique(viewpoint)
    for places in evenly_spaced_subsets(len(seen), min(views, len(seen))):
        found = model.answer(touches.filter(pa.array(np.isin(viewpoint, seen[places]))))
        name, stated = next(iter(found.probabilities.items()))
        # The rule of `unknown`, which models of eleven objects do not state.
        is_novel = (found.novelty_rank or 0.0) >= model.parameters.order_free.coverage - 1e-12
        yield name == category, stated, category in (found.candidates or ()), is_novel


def measure(
    tables: dict[str, pa.Table], learnt: Sequence[str]
) -> dict[tuple[str, int], FloatArray]:
    """Return `FIGURES` of each object, (objects, 4), by strategy of the tested touches and number of views."""
    objects = sorted(set(owners_of(tables[learnt[0]])))
    rows: dict[tuple[str, int], list[FloatArray]] = {}
    for category, name in objects:
        own = {
            strategy: pc.and_(pc.equal(table["class"], category), pc.equal(table["object"], name))
            for strategy, table in tables.items()
        }
        training = pa.concat_tables(tables[one].filter(pc.invert(own[one])) for one in learnt)
        model = fit_model(training, "order_free", "linear_discriminant", RecognitionParameters(), 1)
        for strategy, table in tables.items():
            asked = as_if_learnt(model, strategy)
            for views in VIEWS:
                found = [*answers(asked, table.filter(own[strategy]), views)]
                rows.setdefault((strategy, views), []).append(np.mean(found, axis=0))
    return {key: np.array(found) for key, found in rows.items()}


def main() -> None:
    """Print the mean over objects of each figure, in percent, with its interval."""
    parameters = RecognitionParameters().intervals
    tables = touch_all(STRATEGIES)
    print("learnt | touches | views |", " | ".join(FIGURES))
    for learnt in LEARNT:
        for (strategy, views), found in measure(tables, learnt).items():
            cells = []
            for values in found.T:
                interval = object_interval(values, np.ones(len(values)), parameters)
                cells.append(
                    f"{100 * interval.mean:.1f} ({100 * interval.low:.1f} to {100 * interval.high:.1f})"
                )
            print(" + ".join(learnt), strategy, views, *cells, sep=" | ", flush=True)


if __name__ == "__main__":
    main()
