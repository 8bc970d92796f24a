"""Twenty draws become a small file that the report reads."""

import json

import numpy as np
import pytest
from studies.surfaces import RUN

from draws.keeping import accuracies_of, keep
from draws.study import DRAWS, STUDY
from visuohaptic.base.errors import ReportError
from visuohaptic.report.draws import read_draws
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.figures import Cell

BOXES = (("box", "a"), ("box", "b"))


def cell(*accuracy, objects=BOXES, **named):
    return Cell(objects, np.array(accuracy), np.ones(len(accuracy)), **named)


CELLS = {
    ("first draw", "paper", "fixation", "support_vector_machine"): cell(1.0, 0.75),
    ("further draws", "paper", "random#10", "support_vector_machine"): cell(
        0.25, objects=BOXES[1:]
    ),
    ("further draws", "paper", "random#2", "support_vector_machine"): cell(0.5, 0.5),
    ("first draw", "paper", "random", "support_vector_machine"): cell(0.0, 1.0),
}


def test_twenty_draws_are_touched_once_for_both_pipelines():
    plan = plan_study(STUDY, with_changes(RUN, {"probing.strategies": ["fixation", "random"]}))
    first, further = plan.conditions
    assert first.key is None
    assert [*plan.recomputations] == [further.key]
    strategies = first.parameters.probing.strategies + further.parameters.probing.strategies
    assert len(set(strategies) - {"fixation"}) == DRAWS == 20
    assert further.parameters.recognition.pipelines == ("paper", "order_free")


def test_accuracies_stand_by_object_in_the_order_of_draws():
    found = accuracies_of(CELLS)
    assert found["objects"] == ["box/a", "box/b"]
    paper = found["pipelines"]["paper"]
    assert paper["fixation"] == [1.0, 0.75]
    assert paper["random"] == [[0.0, 1.0], [0.5, 0.5], [None, 0.25]]


def test_a_draw_that_failed_is_refused():
    failed = cell(objects=(), error="No viewpoint has 5 touches.")
    key = ("further draws", "paper", "random#3", "support_vector_machine")
    with pytest.raises(ReportError, match="random#3: No viewpoint has 5 touches"):
        accuracies_of({**CELLS, key: failed})


def test_kept_draws_of_one_set_leave_those_of_others(tmp_path):
    measured, place = tmp_path / "measured.json", tmp_path / "draws.json"
    for name in ("paper", "benchmark"):
        measured.write_text(json.dumps({"set": name, **accuracies_of(CELLS)}))
        keep(name, measured, place)
    assert read_draws("paper", "paper", place).lead.leads == pytest.approx((0.375, 0.375, 0.5))
    assert read_draws("benchmark", "paper", place).random == pytest.approx((0.5, 0.5, 0.25))
    assert '"fixation": [ 1.0, 0.75 ]' in place.read_text()
    with pytest.raises(ReportError, match="has draws of set benchmark; draws of paper are needed"):
        keep("paper", measured, place)
