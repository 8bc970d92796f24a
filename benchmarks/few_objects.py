"""How often models of few objects call an object unknown: `python -m benchmarks.few_objects results/features`.

The features are of a run with `meshes.set: benchmark`. Each draw fits a model on a few objects of four classes, and
classifies the other objects of these classes (known) and the objects of all other classes (foreign), from all views.
The examples of the package are neither learnt nor classified. Docs: docs/certainty.md.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.evaluation.summary import select
from visuohaptic.exploration.examples import examples
from visuohaptic.recognition.model import RecognitionModel, fit_model
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import FEATURES, owners_of
from visuohaptic.tables.schema import read_table

if TYPE_CHECKING:
    from visuohaptic.base.arrays import FloatArray

CLASSES = 4
OBJECTS_PER_CLASS = (3, 5, 8)
DRAWS = 20
FIGURES = ("correct", "conformal set holds", "answer's set holds", "beyond 90 %", "called unknown")
Owner = tuple[str, str]


def draw(owners: Sequence[Owner], learnt: int, generator: np.random.Generator) -> list[Owner]:
    """Draw objects of `CLASSES` classes, `learnt` of each; each class has at least two more objects."""
    names = [category for category, _ in owners]
    large = sorted({name for name in names if names.count(name) >= learnt + 2})
    drawn: list[Owner] = []
    for name in generator.choice(large, CLASSES, replace=False):
        members = [owner for owner in owners if owner[0] == name]
        drawn += [members[index] for index in generator.permutation(len(members))[:learnt]]
    return drawn


def answers(
    model: RecognitionModel, tables: dict[Owner, pa.Table], tested: Sequence[Owner]
) -> Iterator[tuple[float, ...]]:
    """Yield `FIGURES` of each object."""
    for owner in tested:
        found = model.answer(tables[owner])
        yield (
            next(iter(found.probabilities)) == owner[0],
            owner[0] in conformal_set(model, tables[owner]),
            owner[0] in (found.candidates or ()),
            # The rule of `unknown` for any number of training objects.
            (found.novelty_rank or 0.0) >= model.parameters.order_free.coverage - 1e-12,
            bool(found.unknown),
        )


def conformal_set(model: RecognitionModel, touches: pa.Table) -> set[str]:
    """Return the prediction set without the named class, unless the class conforms."""
    (certainty,) = model.certainties.values()
    probabilities = model.recognise(touches)
    logs = np.log([max(probabilities[name], 1e-300) for name in model.classes])
    views = pc.count_distinct(touches["viewpoint"]).as_py()
    coverage = model.parameters.order_free.coverage
    held = certainty.prediction_set(logs, views, coverage)
    return {name for name, in_set in zip(model.classes, held, strict=True) if in_set}


def measure(features: pa.Table, learnt: int) -> tuple[FloatArray, FloatArray]:
    """Return means of `FIGURES` over known and over foreign objects, (`DRAWS`, 5) each."""
    left_out = {
        (path.parent.name, path.name.removesuffix(".ply.gz")) for path in examples().values()
    }
    owners = sorted(set(owners_of(features)) - left_out)
    tables = {owner: select(features, **{"class": owner[0]}, object=owner[1]) for owner in owners}
    known: list[FloatArray] = []
    foreign: list[FloatArray] = []
    for number in range(DRAWS):
        drawn = draw(owners, learnt, np.random.default_rng(number))
        training = pa.concat_tables(tables[owner] for owner in drawn)
        model = fit_model(training, "order_free", "linear_discriminant", RecognitionParameters(), 1)
        rest = [owner for owner in owners if owner not in drawn]
        for found, is_known in ((known, True), (foreign, False)):
            tested = [owner for owner in rest if (owner[0] in model.classes) == is_known]
            found.append(np.mean([*answers(model, tables, tested)], axis=0))
    return np.array(known), np.array(foreign)


def main() -> None:
    """Print the mean over draws of each figure, in percent, with the standard deviation over draws."""
    features = select(read_table(FEATURES, sys.argv[1:]), strategy="fixation")
    print("objects | tested |", " | ".join(FIGURES))
    for learnt in OBJECTS_PER_CLASS:
        for name, found in zip(("known", "foreign"), measure(features, learnt), strict=True):
            cells = [f"{100 * values.mean():.1f} ± {100 * values.std():.1f}" for values in found.T]
            print(CLASSES * learnt, name, *cells, sep=" | ", flush=True)


if __name__ == "__main__":
    main()
