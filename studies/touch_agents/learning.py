"""Train agents with and without sight, and test them once: `python -m touch_agents.learning MESHES FILE`.

MESHES is the folder ``results/meshes`` of a run of set benchmark. `make keep STUDY=touch_agents SET=benchmark FILE=FILE`
keeps the figures. The rule, written before any figure of a test object was computed:

1. Question. After training on the same objects, with as many touches, does an agent that sees recognise more by touch than
   a blind agent? And does training gain more with sight than without?
2. Cells. Two by two: with sight or without, trained or not.

   - With sight the agent may choose among the candidate places of the environment: 5 fixations with 16 spares, and up to 24
     places spread over the visible surface. Of a place before a touch it knows what view, saliency map, depth and outline
     tell there, and distances to earlier touches.
   - Without sight it may choose among as many places as the seeing agent has there, as far as 96 drawn places have so many
     in reach; they are drawn uniformly by area over the whole surface. Of a place before a touch it knows its direction
     from the object's centre, and angles to earlier touches.
   - Both know their touches and the class probabilities so far. An agent without training chooses at random among the same
     places.

3. Learning. Regression trees of scikit-learn predict how much a touch at a place would raise the log probability of the
   true class. A trained agent touches the place with the highest prediction. Class probabilities are those of pipeline
   `order_free` with its linear discriminant, fitted per cell on touches that this cell's agent makes on training objects.
   On training objects the probabilities come from fits on other training objects.
4. Objects. Set benchmark, 142 objects in twelve classes. The 67 objects of classifier_settings/chosen.json train, and in
   three folds of whole objects they validate: settings of the agents are chosen there. The other 75 objects are tested
   once, after all settings are chosen. No touch of a tested object reaches a fit.
5. Settings. ``upright``: the whole pose is known. ``turned``: each object stands turned in any way, eight views show four
   different turns, and recognition knows only the centre. Eight viewpoints; five touches; objects do not move. Random
   choices are averaged over eight sequences per viewpoint.
6. Measure. For each object the share of correct answers after 1, 2, 3 and 5 touches, and the mean of these four shares.
   Figures per number of touches are reported without a test.
7. Tests. In each setting four differences of the mean share, in pairs over the 75 objects, by the sign-change test with the
   intervals of new objects and of new classes. Holm's correction covers all eight p values of new objects.

   - sight after training: (seeing, trained) - (blind, trained)
   - sight in training: ((seeing, trained) - (seeing, random)) - ((blind, trained) - (blind, random))
   - training with sight: (seeing, trained) - (seeing, random)
   - training without sight: (blind, trained) - (blind, random)

8. Answer. A difference is shown if its corrected p value is below 0.05. The answer to a question is ``yes`` if its
   difference is shown and positive. The answer is ``no`` if the difference is shown and negative, or if the interval of new
   objects, uncorrected, lies within ±2 points. Otherwise the answer is ``not settled``. The first difference answers the
   first question, the second the second.

Settings of the trees were chosen on one training fold of turned objects: 40 trees with 300 rows a leaf were level with 100
trees with 100 rows a leaf, and were taken. The cosine between a place's normal and its direction from the centre was added
to what an agent sees before any figure of a tested object. The touches of all candidates are made once, in the environment;
agents are trained on these arrays. A test compares them with the touches of an episode, bit for bit.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any, get_args

import numpy as np

from classifier_settings.half import choosing_objects
from touch_agents.candidates import (
    FRAMES,
    SENSES,
    VIEWPOINTS,
    Candidates,
    Senses,
    Setting,
    collect,
    load_candidates,
    save_candidates,
)
from touch_agents.learner import TOUCHES, Learning, touched, train
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.evaluation.intervals import (
    SHARE,
    SIGNIFICANCE,
    class_interval,
    compare_differences,
    holm,
    object_interval,
    plain_comparison,
    plain_interval,
)
from visuohaptic.evaluation.metrics import round_numbers
from visuohaptic.parameters import ExperimentParameters, as_parameters
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.recognition.splits import held_out_folds

SHOWN = (1, 2, 3, 5)
"""Numbers of touches whose shares of correct answers are averaged."""

SEQUENCES = 8
"""Sequences of touches per viewpoint of a tested object."""

VALIDATION_FOLDS = 3

MARGIN = 0.02
"""A difference that lies within ± this share, with its interval, is none."""

Cell = tuple[Senses, bool]
"""Senses of an agent, and whether it is trained."""

CELLS: tuple[Cell, ...] = tuple(product(SENSES, (False, True)))

DIFFERENCES: Mapping[str, Mapping[Cell, int]] = {
    "sight after training": {("seeing", True): 1, ("blind", True): -1},
    "sight in training": {
        ("seeing", True): 1,
        ("seeing", False): -1,
        ("blind", True): -1,
        ("blind", False): 1,
    },
    "training with sight": {("seeing", True): 1, ("seeing", False): -1},
    "training without sight": {("blind", True): 1, ("blind", False): -1},
}
"""Weight of each cell in each difference of the rule."""


def main() -> None:
    """Measure, and write the figures as JSON to the file that the command names."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("meshes", type=Path, help="such as results/meshes")
    parser.add_argument("output", type=Path, help="such as results/touch_agents_learning.json")
    parser.add_argument("--touches", type=Path, help="folder that keeps the touched candidates")
    parser.add_argument(
        "--validate",
        action="store_true",
        help="train and test on folds of the training objects only",
    )
    arguments = parser.parse_args()
    parameters = as_parameters({"viewpoints.count": VIEWPOINTS})
    seconds = {"touches": 0.0, "training and test": 0.0}
    shares: dict[Setting, dict[Cell, FloatArray]] = {}
    for setting in get_args(Setting):
        candidates, spent = _candidates(arguments.meshes, setting, parameters, arguments.touches)
        seconds["touches"] += spent
        begun, frame, seed = time.process_time(), FRAMES[setting], parameters.seed
        keys = candidates["seeing"].keys
        training = [key for key in keys if key in choosing_objects()]
        tested = [key for key in keys if key not in choosing_objects()]
        if arguments.validate:
            tested, shares[setting] = validate(candidates, training, frame, seed)
        else:
            shares[setting] = measure(candidates, training, tested, frame, seed)
        seconds["training and test"] += time.process_time() - begun
    figures = summarise(shares, tested, parameters.recognition.intervals)
    figures |= {"processor_seconds": seconds, "objects": [len(training), len(tested)]}
    atomic_write_text(arguments.output, json.dumps(round_numbers(figures)) + "\n")
    for row in figures["differences"]:
        mean = 100 * row["comparison"]["difference"]["mean"]
        print(f"{row['setting']} {row['name']}: {mean:+.1f} points, {row['answer']}")


def measure(
    candidates: Mapping[Senses, Candidates],
    training: Sequence[str],
    tested: Sequence[str],
    frame: Frame,
    seed: int,
    learning: Learning | None = None,
) -> dict[Cell, FloatArray]:
    """Train the agent of each cell, and return the share of correct answers after each touch, (o, t), per tested object.

    Raises `ValueError` if an object would both train and be tested.
    """
    if both := sorted({*training} & {*tested}):
        raise ValueError(f"{', '.join(both[:3])} would train and be tested.")
    shares: dict[Cell, FloatArray] = {}
    for senses, trained in CELLS:
        own = candidates[senses]
        agent = train(own, training, frame, learns=trained, seed=seed, learning=learning)
        starts = np.repeat(own.starts_of(tested), SEQUENCES)
        with one_thread():
            chosen = agent.touch(own, starts, np.random.default_rng(seed))
            felt = touched(own, starts, chosen)
            answers = [
                agent.eyes.logs(felt[:, :count]).argmax(axis=1) for count in range(1, TOUCHES + 1)
            ]
        correct = np.stack(answers, axis=1) == own.labels[starts, None]
        owners = own.owners[starts]
        shares[senses, trained] = np.stack(
            [correct[owners == own.keys.index(key)].mean(axis=0) for key in tested]
        )
        print(frame, senses, trained, shares[senses, trained].mean(axis=0).round(3), flush=True)
    return shares


def validate(
    candidates: Mapping[Senses, Candidates],
    training: Sequence[str],
    frame: Frame,
    seed: int,
    learning: Learning | None = None,
) -> tuple[list[str], dict[Cell, FloatArray]]:
    """Return the training objects fold by fold, and `measure` with each fold held out in turn."""
    _, labels = np.unique([key.partition("/")[0] for key in training], return_inverse=True)
    names, parts = np.array(training), []
    folds = held_out_folds(labels, np.arange(len(names)), VALIDATION_FOLDS)
    for train_rows, rows in folds:
        kept, held_out = names[train_rows].tolist(), names[rows].tolist()
        parts.append(measure(candidates, kept, held_out, frame, seed, learning))
    order = np.concatenate([names[rows] for _, rows in folds]).tolist()
    return order, {cell: np.concatenate([part[cell] for part in parts]) for cell in CELLS}


def summarise(
    shares: Mapping[Setting, Mapping[Cell, FloatArray]],
    keys: Sequence[str],
    intervals: IntervalParameters,
) -> dict[str, Any]:
    """Compute accuracies with intervals per cell and number of touches, and the tested differences with answers.

    `shares` are those of `measure`; `keys` are their objects.
    """
    weights, classes = np.ones(len(keys)), [key.partition("/")[0] for key in keys]
    accuracies: list[dict[str, Any]] = []
    differences: list[dict[str, Any]] = []
    for setting, of_cell in shares.items():
        means = {
            cell: values[:, [n - 1 for n in SHOWN]].mean(axis=1) for cell, values in of_cell.items()
        }
        for (senses, trained), values in of_cell.items():
            columns = {str(count): values[:, count - 1] for count in range(1, TOUCHES + 1)}
            for count, column in {**columns, "mean": means[senses, trained]}.items():
                found = {
                    "objects": plain_interval(object_interval(column, weights, intervals, SHARE)),
                    "classes": plain_interval(
                        class_interval(column, weights, classes, intervals, SHARE)
                    ),
                }
                named = {"setting": setting, "senses": senses, "trained": trained}
                accuracies.append({**named, "touches": count, "accuracy": found})
        for name, signs in DIFFERENCES.items():
            gap = np.sum([sign * means[cell] for cell, sign in signs.items()], axis=0)
            bound = len(signs) / 2
            compared = compare_differences(gap, weights, intervals, (-bound, bound), classes)
            differences.append(
                {"setting": setting, "name": name, "comparison": plain_comparison(compared)}
            )
    p_values = [row["comparison"]["p_value"] for row in differences]
    for row, corrected in zip(differences, holm(p_values), strict=True):
        row["corrected"], row["answer"] = corrected, answer(row["comparison"], corrected)
    return {"accuracies": accuracies, "differences": differences}


def answer(comparison: Mapping[str, Any], corrected: float) -> str:
    """Return ``yes``, ``no`` or ``not settled`` by the rule of the module."""
    found = comparison["difference"]
    if corrected < SIGNIFICANCE:
        return "yes" if found["mean"] > 0 else "no"
    within = found["low"] >= -MARGIN and found["high"] <= MARGIN
    return "no" if within else "not settled"


def _candidates(
    meshes: Path, setting: Setting, parameters: ExperimentParameters, folder: Path | None
) -> tuple[dict[Senses, Candidates], float]:
    """Touch the candidates, or read the file of `folder` that holds them; return the processor seconds of touching too."""
    file = None if folder is None else folder / f"{setting}.npz"
    if file is not None and file.exists():
        return load_candidates(file)
    begun = time.process_time()
    found = collect(meshes, setting, parameters)
    seconds = time.process_time() - begun
    if file is not None:
        save_candidates(found, seconds, file)
    return found, seconds


if __name__ == "__main__":
    main()
