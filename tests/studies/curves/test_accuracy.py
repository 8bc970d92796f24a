"""Curves over touches, an object each: sequences as they are, or chosen split by split."""

import numpy as np
import pyarrow as pa
import pytest
from recognition.synthetic import features_table

from visuohaptic import recognition
from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.studies.curves.accuracy import object_curves
from visuohaptic.studies.curves.features import begin_anew
from visuohaptic.tables.phases import FIXATIONS
from visuohaptic.tables.schema import build_table, check_table, matrix
from visuohaptic.tables.studies import CURVES

PARAMETERS = RecognitionParameters.model_validate(
    {"protocol": {"maximum_splits": 6}, "best": {"waves": 20}}
)
ONE = PARAMETERS.model_copy(
    update={
        "classifiers": ("support_vector_machine",),
        "best": PARAMETERS.best.model_copy(update={"classifiers": ("support_vector_machine",)}),
    }
)


def curves(table, pipeline, touches, seed=1):
    return object_curves(table, PARAMETERS, 0.2, seed, pipeline, touches)


@pytest.mark.parametrize("pipeline", ["paper", "best"])
def test_each_point_is_the_run_with_so_many_touches(pipeline):
    table = features_table(touches=4, viewpoints=2, separation=2.0)
    found = curves(table, pipeline, [1, 3])
    check_table(CURVES, found)
    taken = ONE.model_copy(update={"touches": 3})
    tables = recognition.run_pipeline(table, taken, 1, pipeline)
    expected = recognition.summarise(*tables, seed=1)["results"][pipeline]["fixation"]
    rows = [row for row in found.to_pylist() if row["touches"] == 3]
    accuracy, weights = (np.array([row[name] for row in rows]) for name in ("accuracy", "weight"))
    mean = expected["support_vector_machine"]["accuracy"]["mean"]
    assert np.average(accuracy, weights=weights) == pytest.approx(mean)
    assert len(rows) == 12


@pytest.mark.slow
@pytest.mark.parametrize("pipeline", ["paper", "best"])
def test_adaptive_touches_are_tested_on_the_same_objects_and_repeatable(pipeline):
    table = features_table("adaptive", touches=8, viewpoints=2, separation=4.0)
    found = curves(table, pipeline, [1, 3])
    assert found.equals(curves(table, pipeline, [1, 3]))
    other = curves(features_table(touches=4, viewpoints=2), pipeline, [1, 3])
    for name in ("class", "object", "touches", "weight"):
        assert found.column(name).equals(other.column(name))
    assert found.column("accuracy").to_numpy().mean() > 0.5


def test_adaptive_touches_of_a_longer_curve_begin_as_those_of_a_shorter_one():
    table = features_table("adaptive", touches=8, viewpoints=2)
    longer, shorter = curves(table, "paper", [1, 2, 4]), curves(table, "paper", [1, 2])
    assert longer.slice(0, shorter.num_rows).equals(shorter)


def test_no_touches_are_refused():
    table = features_table(touches=2)
    with pytest.raises(RecognitionError, match="no touches"):
        curves(table.slice(0, 0), "paper", [1])


def sequence(count):
    columns = dict.fromkeys(("pixel_row", "pixel_column", "saliency"), [None] * count)
    columns |= dict.fromkeys(("y", "z", "normal_x", "normal_y", "normal_z"), 0.0)
    columns |= {"class": "a", "object": "b", "viewpoint": 0, "strategy": "fixation", "face": 0}
    columns |= {"x": np.arange(count) / 10, "touch": np.arange(count)}
    return build_table(FIXATIONS, columns)


def test_an_exhausted_view_begins_anew():
    longer = begin_anew(sequence(3), 7)
    check_table(FIXATIONS, longer)
    assert longer.column("touch").to_pylist() == list(range(7))
    np.testing.assert_allclose(matrix(longer, ["x"])[:, 0], [0, 0.1, 0.2, 0, 0.1, 0.2, 0])
    assert begin_anew(sequence(7), 7).equals(sequence(7))


def test_a_view_without_any_place_stays_empty():
    empty = sequence(1).slice(0, 0)
    assert begin_anew(empty, 5).num_rows == 0
    assert isinstance(empty, pa.Table)
