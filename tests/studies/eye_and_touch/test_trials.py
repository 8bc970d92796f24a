"""Looking, touching and both are measured in the same splits, and paid for at their prices."""

import numpy as np
import pytest
from recognition.synthetic import features_table

from eye_and_touch.seeing import SIGHTS
from eye_and_touch.sensing import ADAPTIVE, BLIND, STRATEGIES, Sensed, most_touches
from eye_and_touch.study import (
    CHECKED,
    CLEAN,
    CUES,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)
from eye_and_touch.tables import EYE_AND_TOUCH
from eye_and_touch.trials import measure_senses
from touch_curves.learning import gather_candidates
from visuohaptic.evaluation.summary import select
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.tables.schema import check_table

pytestmark = pytest.mark.slow

RUN = ExperimentParameters.from_mapping(
    {
        "attention": {"fixations": 2},
        "recognition": {
            "touches": 2,
            "order_free": {"waves": 20},
            "protocol": {"maximum_splits": 1, "folds": 2, "fold_rounds": 1},
        },
        "cost": {"budgets": [4, 10.5, 16]},
    }
)


@pytest.fixture(scope="module")
def sensed():
    """Return classes apart in the view and, less so, in touch: views of noise in every sight but the first."""
    touches = most_touches(RUN)
    recognition = RUN.recognition.model_copy(update={"touches": touches})
    tables = [
        features_table(strategy, (4, 4, 4), 2, touches, 1.0, seed)
        for seed, strategy in enumerate((*STRATEGIES, ADAPTIVE))
    ]
    gathered = [gather_pipeline(table, recognition, "order_free") for table in tables[:-1]]
    candidates = gather_candidates(tables[-1], gathered[0].feature_names)
    sequences, generator = candidates.sequences, np.random.default_rng(11)
    of_class = generator.normal(size=(len(sequences.classes), 30))
    seen = generator.normal(scale=5, size=(len(sequences.labels), len(SIGHTS), 30))
    seen[:, 0] = of_class[sequences.labels] + generator.normal(scale=1.3, size=seen[:, 0].shape)
    touched = {name: one.features for name, one in zip(STRATEGIES, gathered, strict=True)}
    return Sensed(sequences, dict.fromkeys(CUES, seen.astype(np.float32)), touched, candidates)


@pytest.fixture(scope="module")
def measured(sensed):
    return measure_senses(sensed, RUN, processes=1)


def mean(table, column="accuracy", **values):
    return float(np.mean(select(table, **values).column(column).to_numpy()))


def test_every_answer_is_measured_for_every_object_in_the_same_splits(measured, sensed):
    check_table(EYE_AND_TOUCH, measured)
    # A gap is what is right less what was said to be.
    assert all(sum(row["gaps"]) < row["trials"] * row["accuracy"] for row in measured.to_pylist())
    every = {CLEAN: {*CUES, TOUCH, PRODUCT, CHECKED, SIDE_BY_SIDE, STOPPING}}
    for sight in SIGHTS:
        rows = select(measured, sight=sight)
        found = set(rows.column("answer").to_pylist())
        assert found == every.get(sight, every[CLEAN] - {TOUCH})
        of_object = rows.group_by(["answer", "class", "object", "split"]).aggregate([])
        assert of_object.num_rows == len(found) * len(sensed.sequences.objects)


def test_the_number_of_processes_changes_nothing(sensed, measured):
    assert measure_senses(sensed, RUN, processes=2).equals(measured)


def test_a_poor_sight_is_worse_and_its_checked_product_is_worth_touch_alone(measured):
    clean = mean(measured, answer=LOOK, sight=CLEAN)
    assert clean > 0.8
    assert all(mean(measured, answer=LOOK, sight=one) < clean for one in set(SIGHTS) - {CLEAN})
    for strategy in STRATEGIES:
        touch, dark = (
            mean(measured, answer=answer, strategy=strategy, touches=2, sight=sight)
            for answer, sight in ((TOUCH, CLEAN), (CHECKED, "dark"))
        )
        assert dark == pytest.approx(touch, abs=0.1)
        assert dark > mean(measured, answer=PRODUCT, strategy=strategy, touches=2, sight="dark")


def test_a_look_and_touches_are_paid_and_a_blind_touch_pays_no_look(measured):
    cost = RUN.cost
    assert mean(measured, "seconds", answer=LOOK) == cost.look_seconds
    for strategy in (*STRATEGIES, ADAPTIVE):
        looked = 0 if strategy == BLIND else cost.look_seconds
        alone = mean(measured, "seconds", answer=TOUCH, strategy=strategy, touches=2)
        both = mean(measured, "seconds", answer=PRODUCT, strategy=strategy, touches=2)
        assert alone == pytest.approx(looked + 2 * cost.touch_seconds)
        assert both == pytest.approx(cost.look_seconds + 2 * cost.touch_seconds)


def test_a_rule_that_takes_all_touches_answers_as_the_product_after_them(measured):
    def by_trial(table):
        keys = ("sight", "strategy", "class", "object", "split")
        return {tuple(row[key] for key in keys): row["gaps"] for row in table.to_pylist()}

    touches = most_touches(RUN)
    seconds = RUN.cost.look_seconds + touches * RUN.cost.touch_seconds
    stopped = by_trial(select(measured, answer=STOPPING, seconds=seconds))
    assert stopped
    assert stopped.items() <= by_trial(select(measured, answer=CHECKED, touches=touches)).items()
