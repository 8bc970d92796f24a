"""Prediction sets and the answer `unknown`, measured."""

import json

import numpy as np
import pyarrow.compute as pc
import pytest
from recognition.synthetic import features_table

from trust.classes_left_out import make_trust, measure_trust, summarise_trust
from trust.tables import TRUST
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.summary import select
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table

PARAMETERS = RecognitionParameters()


@pytest.fixture(scope="module")
def measured():
    table = features_table(objects=(8, 8, 8), viewpoints=4, separation=2.0)
    return measure_trust(table, "fixation", "naive_bayes", PARAMETERS, 1)


@pytest.mark.slow
def test_every_object_is_unknown_once_and_no_model_knows_its_class(measured):
    strange = select(measured, known=False, views=1)
    assert strange.num_rows == 24
    assert strange.column("class").equals(strange.column("left_out"))
    assert not any(row["covered"] or row["covered_at"] for row in strange.to_pylist())
    known = select(measured, known=True).to_pylist()
    assert known
    assert all(row["class"] != row["left_out"] for row in known)
    assert all(row["covered"] == (90 in row["covered_at"]) for row in known)


@pytest.mark.slow
def test_sets_of_another_coverage_are_those_that_would_be_given_where_it_is_stated():
    table = features_table(objects=(16, 16, 16), viewpoints=1, separation=0.3)
    own = PARAMETERS.order_free.model_copy(update={"coverage": 0.8})
    other = PARAMETERS.model_copy(update={"order_free": own})
    ours, theirs = (
        select(measure_trust(table, "fixation", "naive_bayes", one, 1), known=True).to_pylist()
        for one in (PARAMETERS, other)
    )
    covered = [row["covered"] for row in theirs]
    assert [80 in row["covered_at"] for row in ours] == covered


def test_unknown_objects_are_stranger_than_known_ones(measured):
    found = summarise_trust(measured, 0.9, IntervalParameters())
    (figures,) = [one for one in found if one["views"] == 4]
    assert figures["area"] > 0.9
    assert figures["coverage"][0] > 0.7
    assert figures["found_unknown"][0] > figures["false_unknown"][0]


def test_fewer_than_three_classes_are_refused():
    with pytest.raises(RecognitionError, match="2 classes"):
        measure_trust(features_table(objects=(3, 3)), "fixation", "naive_bayes", PARAMETERS, 1)


@pytest.mark.parametrize("category", ["class0", "class1"])
def test_an_object_with_a_view_less_is_compared_with_the_others(category):
    table = features_table(objects=(3, 3, 3), viewpoints=4, separation=2.0)
    of_object = (pc.field("class") == category) & (pc.field("object") == "object0")
    shown = table.filter(~(of_object & (pc.field("viewpoint") == 3)))
    found = measure_trust(shown, "fixation", "naive_bayes", PARAMETERS, 1)
    figures = summarise_trust(found, 0.9, IntervalParameters())
    assert [one["views"] for one in figures] == [1, 4]
    assert all(np.isfinite(one["area"]) for one in figures)


def test_table_and_summary_are_written(tmp_path):
    table = features_table(objects=(3, 3, 3), viewpoints=2, separation=2.0)
    features, *files = (tmp_path / name for name in ("features", "trust", "summary"))
    write_table(FEATURES, table, features)
    run = ExperimentParameters.from_mapping({"probing": {"strategies": ["fixation"]}})
    make_trust(StepInputs("trust", {"features": [features]}, files, run))
    assert read_table(TRUST, files[0]).num_rows
    assert {one["views"] for one in json.loads(files[1].read_text())} == {1, 2}
