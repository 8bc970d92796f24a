"""Twenty draws become a small file that the report reads."""

import json
from collections import Counter
from operator import attrgetter

import numpy as np
import pytest
from studies.surfaces import RUN

from draws.keeping import accuracies_of, keep
from draws.study import DRAWS, LITERAL_DRAWS, STUDY
from variants.choices import BY_NAME
from variants.design import LITERAL
from visuohaptic.base.draws import draw_of
from visuohaptic.base.errors import ReportError
from visuohaptic.report.draws import read_draws
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.figures import Cell

BOXES = (("box", "a"), ("box", "b"))


def cell(*accuracy, objects=BOXES, **named):
    return Cell(objects, np.array(accuracy), np.ones(len(accuracy)), **named)


CELLS = {
    ("default, first draw", "paper", "fixation", "support_vector_machine"): cell(1.0, 0.75),
    ("default, further draws", "paper", "random#10", "support_vector_machine"): cell(
        0.25, objects=BOXES[1:]
    ),
    ("default, further draws", "paper", "random#2", "support_vector_machine"): cell(0.5, 0.5),
    ("default, first draw", "paper", "random", "support_vector_machine"): cell(0.0, 1.0),
    ("default, first draw", "paper", "random_visible", "support_vector_machine"): cell(0.5, 0.0),
    ("literal, first draw", "paper", "fixation", "support_vector_machine"): cell(0.25, 0.0),
    ("literal, first draw", "paper", "random", "support_vector_machine"): cell(0.0, 0.25),
}


def test_draws_in_reach_and_in_sight_are_touched_once_for_both_pipelines():
    strategies = ["fixation", "random", "random_visible"]
    plan = plan_study(STUDY, with_changes(RUN, {"probing.strategies": strategies}))
    first, further, *literal = plan.conditions
    assert first.key is None
    assert [*plan.recomputations] == [further.key, literal[0].key]
    assert literal[0].key == literal[1].key
    for pair, draws in (((first, further), DRAWS), (literal, LITERAL_DRAWS)):
        drawn = Counter(
            draw_of(name)[0] for one in pair for name in one.parameters.probing.strategies
        )
        assert drawn == {"fixation": 1, "random": draws, "random_visible": draws}
    assert (DRAWS, LITERAL_DRAWS) == (20, 5)
    assert further.parameters.recognition.pipelines == ("paper", "order_free")
    assert literal[1].parameters.recognition.pipelines == ("paper",)


def test_the_literal_variant_has_all_of_its_options():
    literal = plan_study(STUDY, RUN).conditions[-1].parameters
    for choice, option in LITERAL.items():
        if choice == "random_probing":
            continue
        for name, value in BY_NAME[choice].options[option].items():
            assert attrgetter(name)(literal) == value


def test_accuracies_stand_by_object_in_the_order_of_draws():
    found = accuracies_of(CELLS)
    assert found["objects"] == ["box/a", "box/b"]
    paper = found["pipelines"]["paper"]
    assert paper["fixation"] == [1.0, 0.75]
    assert paper["draws"] == {
        "random": [[0.0, 1.0], [0.5, 0.5], [None, 0.25]],
        "random_visible": [[0.5, 0.0]],
    }
    literal = found["pipelines"]["literal"]
    assert literal["fixation"] == [0.25, 0.0]
    assert literal["draws"] == {"random": [[0.0, 0.25]]}


def test_a_draw_that_failed_is_refused():
    failed = cell(objects=(), error="No viewpoint has 5 touches.")
    key = ("default, further draws", "paper", "random#3", "support_vector_machine")
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
