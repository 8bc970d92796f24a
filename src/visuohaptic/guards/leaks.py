"""Guards against test objects that take part in training."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.guards.verdicts import Verdict, highest_mean, judge
from visuohaptic.recognition.experiment import (
    fitting,
    gather_pipeline,
    run_paper_split,
    split_runner,
)
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.recognition.splits import Split, make_splits

SHUFFLES = 40
MEMORISING = "decision_tree"
"""A classifier that gives back what it was trained with, so that a leak shows in full."""

NOISE = 1e3
"""Deviation of the noise: what is fitted on it classifies nothing else correctly."""

CLASSES, OBJECTS_OF_A_CLASS, VIEWS = 4, 3, 8
"""Of larger runs a sample is taken, so that guards take the same time in all."""

CHANCE = "shuffled labels give chance"
UNSEEN = "test objects change nothing that is fitted"


def sample_objects(features: pa.Table, generator: np.random.Generator) -> pa.Table:
    """Take the rows, in order, of some classes, some objects of each with at least two, and some views."""
    names = np.array(features.column("class").to_pylist(), dtype=object)
    objects = np.array(features.column("object").to_pylist(), dtype=object)
    members = {name: sorted(set(objects[names == name])) for name in sorted(set(names))}
    usable = [name for name, found in members.items() if len(found) > 1]
    chosen = {
        (name, one)
        for name in generator.permutation(usable)[:CLASSES].tolist()
        for one in generator.permutation(members[name])[:OBJECTS_OF_A_CLASS].tolist()
    }
    viewpoint = features.column("viewpoint").to_numpy()
    first = np.isin(viewpoint, np.unique(viewpoint)[:VIEWS])
    kept = [owner in chosen for owner in zip(names, objects, strict=True)]
    return features.filter(pa.array(np.array(kept, dtype=bool) & first))


def guard_chance(
    sequences: TouchSequences, parameters: RecognitionParameters, generator: np.random.Generator
) -> Verdict:
    """Shuffle the classes over objects, and want the accuracy of chance.

    Test objects whose sequences also train are then recognised all the same. Each shuffle tests one
    split; the mean over classes of the share correctly classified has the expectation 1/c for c
    classes, as the labels of a split's test objects are as likely in any order.
    """
    if parameters.protocol.protocol == "new_viewpoint":
        return Verdict(CHANCE, "not tested", "The protocol trains on other views of each object.")
    quick = parameters.model_copy(update={"classifiers": (MEMORISING,)})
    found = [_accuracy_of_shuffle(sequences, quick, generator) for _ in range(SHUFFLES)]
    mean, expected = np.mean([accuracy for accuracy, _ in found]), np.mean([p for _, p in found])
    limit = highest_mean(float(expected), SHUFFLES)
    if limit >= 1:
        return Verdict(CHANCE, "not tested", "There are too few classes.")
    return judge(
        CHANCE,
        held=bool(mean < limit),
        found=f"{SHUFFLES} shuffles give {mean:.0%} correctly classified, chance gives "
        f"{expected:.0%}, and less than {limit:.0%} is allowed.",
    )


def _accuracy_of_shuffle(
    sequences: TouchSequences, parameters: RecognitionParameters, generator: np.random.Generator
) -> tuple[float, float]:
    """Give the mean over classes of a split's accuracy under shuffled classes, and what chance gives."""
    classes = generator.permutation([name for name, _ in sequences.objects]).tolist()
    names = [name for _, name in sequences.objects]
    objects = tuple(
        (one, f"{place} {name}")
        for place, (one, name) in enumerate(zip(classes, names, strict=True))
    )
    shuffled = replace(sequences, objects=objects)
    splits = make_splits(shuffled, parameters.protocol, generator)
    split = splits[generator.integers(len(splits))]
    (answer,) = run_paper_split(shuffled, parameters, split, generator)
    right = answer.predicted == shuffled.labels[split.test]
    owners = shuffled.object_index[split.test]
    tested = np.unique(owners)
    by_object = np.array([right[owners == one].mean() for one in tested])
    of_class = shuffled.class_of_object[tested]
    by_class = [by_object[of_class == one].mean() for one in np.unique(of_class)]
    return float(np.mean(by_class)), 1 / len(by_class)


def guard_unseen(
    features: pa.Table,
    pipeline: str,
    parameters: RecognitionParameters,
    seed: int,
    generator: np.random.Generator,
) -> Verdict:
    """Replace test objects by noise, and want the other test sequences classified as before.

    The rows of `tables.FEATURES` are of one strategy; the generator draws the split and the noise.
    """
    guard = f"{UNSEEN}, pipeline {pipeline}"
    sequences = gather_pipeline(features, parameters, pipeline, seed)
    splits = make_splits(sequences, parameters.protocol, generator)
    split = splits[generator.integers(len(splits))]
    noisy = _noisy_sequences(split, sequences)
    values = sequences.features.copy()
    values[noisy] = NOISE * generator.normal(size=values[noisy].shape)
    before, after = (
        _predict(replace(sequences, features=each), split, pipeline, parameters)
        for each in (sequences.features, values)
    )
    same = ~np.isin(split.test, noisy)
    changed = [name for name in before if not np.array_equal(before[name][same], after[name][same])]
    return judge(
        guard,
        held=not changed,
        found=f"With {len(noisy)} test sequences replaced by noise, the other {same.sum()} are "
        + (
            f"classified otherwise by {', '.join(changed)}." if changed else "classified as before."
        ),
    )


def _noisy_sequences(split: Split, sequences: TouchSequences) -> NDArray[np.int64]:
    """Choose half of the test objects' sequences; half of its sequences where there is one object."""
    owners = sequences.object_index[split.test]
    tested = np.unique(owners)
    if len(tested) == 1:
        return split.test[len(split.test) // 2 :]
    return split.test[np.isin(owners, tested[len(tested) // 2 :])]


def _predict(
    sequences: TouchSequences, split: Split, pipeline: str, parameters: RecognitionParameters
) -> dict[str, NDArray[np.int64] | NDArray[np.float64]]:
    """Give by classifier what it predicts for a split's n test sequences: classes, or probabilities, shape (n, c)."""
    answer_split = split_runner(sequences, parameters, 0, pipeline)
    with fitting():
        return {
            answer.classifier: answer.predicted
            if answer.ballots is None
            else answer.ballots.alone()
            for answer in answer_split(split, np.random.default_rng(0))
        }
