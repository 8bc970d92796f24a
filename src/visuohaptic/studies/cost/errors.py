"""How often each setting names an object wrongly; the same input gives the same numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.attention.errors import AttentionError
from visuohaptic.contourlet.errors import ContourletError
from visuohaptic.errors import RecognitionError, VisuohapticError
from visuohaptic.features.describing import describe_touches
from visuohaptic.fixations.locations import locate, look
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.experiment import Answer, answer_splits, gather_pipeline
from visuohaptic.recognition.intervals import object_interval
from visuohaptic.recognition.sequences import TouchSequences, classes_of_two
from visuohaptic.recognition.splits import Split
from visuohaptic.recognition.summary import select
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.cost.settings import (
    STRATEGY,
    Changes,
    Setting,
    condition_of,
    hashable,
    with_changes,
)
from visuohaptic.tables.schema import build_table
from visuohaptic.tables.studies import COST_ERRORS
from visuohaptic.touches.touching import touch_locations, touch_table

REFUSALS = (VisuohapticError, AttentionError, ContourletError)
"""What a setting may fail with; anything else is a fault of the program."""

VIEWS_AT_ONCE = 4


@dataclass(frozen=True)
class ErrorRate:
    """Share of objects named wrongly, its interval over objects, and their number."""

    error: float
    low: float
    high: float
    objects: int


@dataclass(frozen=True)
class RunTables:
    """What a run has already: where its eye rested, and what its touches felt like.

    Attributes
    ----------
    fixations, features : pyarrow.Table
        Rows of the run's strategy `STRATEGY`.
    """

    fixations: pa.Table
    features: pa.Table


def setting_features(
    surfaces: Mapping[str, Surface],
    settings: Sequence[Setting],
    tables: RunTables,
    run: ExperimentParameters,
) -> dict[Changes, pa.Table | str]:
    """Give the features that settings need, without doing again what the run has done.

    Parameters
    ----------
    surfaces : mapping of str to Surface
        Every object of the run by its key.
    settings : sequence of Setting
        The settings.
    tables : RunTables
        What there is.
    run : ExperimentParameters
        The run's parameters.

    Returns
    -------
    dict of tuple to (pyarrow.Table or str)
        By the changes before recognition: rows of `tables.FEATURES`, or the sentence by which
        they were refused.
    """
    most: dict[Changes, int] = {}
    for setting in settings:
        key = condition_of(setting)
        most[key] = max(most.get(key, 0), setting.touches)
    found: dict[Changes, pa.Table | str] = {}
    for setting in settings:
        key = condition_of(setting)
        if key in found:
            continue
        try:
            found[key] = _features(surfaces, setting.before_recognition, most[key], tables, run)
        except REFUSALS as refusal:
            found[key] = str(refusal)
    return found


def features_of(found: Mapping[Changes, pa.Table | str], setting: Setting) -> pa.Table | str:
    """Give what `setting_features` found for a setting."""
    return found[condition_of(setting)]


@dataclass(frozen=True)
class Answers:
    """What every split's training named, before any vote.

    Attributes
    ----------
    sequences : TouchSequences
        All sequences.
    splits : list of (Split, Answer)
        One classifier's answers, over all splits and repeats.
    """

    sequences: TouchSequences
    splits: list[tuple[Split, Answer]]


def ask(features: pa.Table, setting: Setting, run: ExperimentParameters) -> Answers:
    """Train and test a setting; the number of viewpoints that vote has no say in it.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES`, with at least the setting's touches.
    setting : Setting
        The setting.
    run : ExperimentParameters
        The run's parameters: the protocol is its own.

    Returns
    -------
    Answers
        What was named.

    Raises
    ------
    RecognitionError
        If the features don't allow the experiment.
    """
    recognition = setting.parameters(run).recognition
    sequences = gather_pipeline(classes_of_two(features), recognition, setting.pipeline)
    answers = answer_splits(sequences, recognition, run.seed, setting.pipeline)
    return Answers(sequences, [(split, answer) for split, _, answer in answers])


def error_rate(answers: Answers, setting: Setting, run: ExperimentParameters) -> ErrorRate:
    """Let viewpoints vote, and count how often the vote is wrong.

    Parameters
    ----------
    answers : Answers
        What `ask` gives for the setting.
    setting : Setting
        The setting. Where several viewpoints vote, every evenly spread choice of so many of an
        object's viewpoints counts as one recognition.
    run : ExperimentParameters
        The run's parameters: the intervals are its own.

    Returns
    -------
    ErrorRate
        Where no object was ever named wrongly, no resampling can tell how far the rate may be
        from 0; its upper end is then the exact binomial one for so many objects (C. Clopper
        and E. Pearson, Biometrika 26(4), 1934).

    Raises
    ------
    RecognitionError
        If there are not so many viewpoints.
    """
    sequences, intervals = answers.sequences, run.recognition.intervals
    numbers = np.unique(sequences.viewpoint)
    if setting.viewpoints > len(numbers):
        raise RecognitionError(
            f"{setting.viewpoints} viewpoints can't vote, for the run has {len(numbers)}."
        )
    viewpoint = np.searchsorted(numbers, sequences.viewpoint)
    choices = spread_choices(len(numbers), setting.viewpoints)
    right, tested = np.zeros(len(sequences.objects)), np.zeros(len(sequences.objects))
    for split, answer in answers.splits:
        owners, credit = _credit(sequences, split, answer, viewpoint, choices)
        # Every split weighs the same, whatever it tests.
        right[owners] += credit / len(owners)
        tested[owners] += 1 / len(owners)
    right, tested = right[tested > 0], tested[tested > 0]
    # Sums of shares may miss 1 by a rounding.
    if np.all(right > tested * (1 - 1e-12)):
        high = clopper_pearson_high(len(tested), intervals.confidence)
        return ErrorRate(0.0, 0.0, high, len(tested))
    # One and the same resampling for all, so that what is alike in two families looks alike.
    generator = spawn_generator(run.seed, "cost")
    wrong = object_interval(1 - right / tested, tested, intervals, generator)
    low, high = (min(max(end, 0.0), 1.0) for end in (wrong.low, wrong.high))
    return ErrorRate(wrong.mean, low, high, len(tested))


def clopper_pearson_high(objects: int, confidence: float) -> float:
    """Give the upper end of the exact binomial interval of no error among so many objects."""
    return float(1 - ((1 - confidence) / 2) ** (1 / objects))


def spread_choices(total: int, count: int) -> NDArray[np.int64]:
    """Choose places evenly spread over a ring, in every way.

    Parameters
    ----------
    total : int
        Places of the ring.
    count : int
        How many to choose, at most `total`.

    Returns
    -------
    numpy.ndarray
        Shape (choices, count), int64: each choice turned on by one place, none twice.
    """
    steps = (np.arange(count) * total) // count
    turned = (steps + np.arange(total)[:, None]) % total
    return np.unique(np.sort(turned, axis=1), axis=0)


def measure_errors(
    settings: Sequence[Setting],
    found: Mapping[Changes, pa.Table | str],
    run: ExperimentParameters,
) -> pa.Table:
    """Train and test settings; one that can't be run keeps its row, with the reason.

    Parameters
    ----------
    settings : sequence of Setting
        The settings.
    found : mapping
        What `setting_features` gives for them.
    run : ExperimentParameters
        The run's parameters.

    Returns
    -------
    pyarrow.Table
        `tables.COST_ERRORS`, a row a setting.
    """
    asked: dict[Setting, Answers] = {}
    rows = []
    for setting in settings:
        row: dict[str, object] = {
            "family": setting.family,
            "setting": setting.name,
            "place": setting.place,
            "touches": setting.touches,
            "viewpoints": setting.viewpoints,
            "pipeline": setting.pipeline,
            "classifier": setting.classifier,
            "changes": setting.written_changes,
            **dict.fromkeys(("error", "error_low", "error_high", "objects", "failed")),
        }
        try:
            rate = _rate(setting, features_of(found, setting), run, asked)
            row |= {"error": rate.error, "error_low": rate.low, "error_high": rate.high}
            row["objects"] = rate.objects
        except REFUSALS as refusal:
            row["failed"] = str(refusal)
        rows.append(row)
    return build_table(COST_ERRORS, {name: [row[name] for row in rows] for name in rows[0]})


def _rate(
    setting: Setting,
    features: pa.Table | str,
    run: ExperimentParameters,
    asked: dict[Setting, Answers],
) -> ErrorRate:
    """Measure one setting; settings that differ in the vote alone are asked once."""
    if isinstance(features, str):
        raise RecognitionError(features)
    alone = replace(setting, name="", place=0, viewpoints=1, changes=hashable(setting.changes))
    if alone not in asked:
        asked[alone] = ask(features, setting, run)
    return error_rate(asked[alone], setting, run)


def _features(
    surfaces: Mapping[str, Surface],
    changes: Changes,
    touches: int,
    tables: RunTables,
    run: ExperimentParameters,
) -> pa.Table:
    more = touches > run.attention.fixations
    if not changes and not more:
        return tables.features
    own: Changes = (("attention.fixations", touches),) if more else ()
    parameters = with_changes(run, (*changes, *own))
    same_eye = not more and all(_by_hand(path) for path, _ in changes)
    parts = []
    for key, surface in surfaces.items():
        caster = RayCaster(surface)
        category, name = key.split("/")
        fixations = (
            select(tables.fixations, **{"class": category}, object=name)
            if same_eye
            else find_fixations(caster, key, parameters)
        )
        felt = touch_locations(caster, fixations, parameters.sensor, parameters.scene, run.seed)
        parts.append(describe_touches(touch_table(fixations, felt), parameters.features))
    return pa.concat_tables(parts)


def find_fixations(
    caster: RayCaster,
    key: str,
    parameters: ExperimentParameters,
    viewpoints: Sequence[int] | None = None,
) -> pa.Table:
    """Look at an object, and give where the eye rests.

    Parameters
    ----------
    caster : RayCaster
        The object.
    key : str
        `class/name` of the object.
    parameters : ExperimentParameters
        How to look.
    viewpoints : sequence of int, optional
        Numbers of the viewpoints; all without it.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.FIXATIONS`, the same as the workflow finds.
    """
    placed = place_cameras(parameters.viewpoints)
    numbers = list(range(len(placed)) if viewpoints is None else viewpoints)
    parts = []
    for start in range(0, len(numbers), VIEWS_AT_ONCE):
        cameras = {number: placed[number] for number in numbers[start : start + VIEWS_AT_ONCE]}
        looks = look(
            caster,
            key,
            cameras,
            parameters.rendering,
            parameters.attention,
            parameters.scene.effects,
        )
        parts += [locate(one, STRATEGY, parameters.attention, parameters.seed) for one in looks]
    return pa.concat_tables(parts)


def _by_hand(path: str) -> bool:
    """Tell whether a parameter has a say in touches but none in where they are made."""
    return path == "scene" or path.startswith("sensor.")


def _credit(
    sequences: TouchSequences,
    split: Split,
    answer: Answer,
    viewpoint: NDArray[np.int64],
    choices: NDArray[np.int64],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Give the tested objects, and how often, over the choices of viewpoints, each is named rightly."""
    owners, row = np.unique(sequences.object_index[split.test], return_inverse=True)
    votes = answer.probabilities
    if votes is None:
        votes = np.eye(len(sequences.classes))[answer.predicted]
    by_view = np.zeros((len(owners), int(choices.max()) + 1, votes.shape[1]))
    there = np.zeros(by_view.shape[:2], dtype=bool)
    by_view[row, viewpoint[split.test]] = votes
    there[row, viewpoint[split.test]] = True
    if choices.shape[1] > 1 and not there.all():
        raise RecognitionError(
            "Objects are tested from some of their viewpoints alone, so not all of these can vote; "
            "choose a protocol that tests whole objects."
        )
    sums = by_view[:, choices].sum(axis=2)
    most = sums == sums.max(axis=2, keepdims=True)
    true = sequences.class_of_object[owners]
    own = most[np.arange(len(owners)), :, true]
    credit = np.where(own, 1.0 / most.sum(axis=2), 0.0)
    counted = there[:, choices].all(axis=2)
    return owners, (credit * counted).sum(axis=1) / counted.sum(axis=1)


def _share(value: float) -> float:
    return min(max(value, 0.0), 1.0)
