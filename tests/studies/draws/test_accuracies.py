"""Twenty draws become a table with one row per object and draw."""

from collections import Counter
from operator import attrgetter

import numpy as np
import pytest
from studies.surfaces import RUN

from draws.accuracies import arrange, make_draws
from draws.kept import read_draws
from draws.study import DRAWS, LITERAL_DRAWS, STUDY
from variants.choices import BY_NAME
from variants.design import LITERAL
from visuohaptic.base.draw_names import draw_of
from visuohaptic.base.errors import ReportError
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.figures import Cell
from visuohaptic.studies.keeping import keep
from visuohaptic.studies.study import StepInputs

BOXES = (("box", "a"), ("box", "b"))


def cell(*accuracy, objects=BOXES, weights=None, **named):
    weights = np.ones(len(accuracy)) if weights is None else np.array(weights)
    return Cell(objects, np.array(accuracy), weights, **named)


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


def accuracies_by_draw(table, pipeline):
    """Return accuracies by strategy and draw, then object."""
    rows = table.to_pandas().query("pipeline == @pipeline")
    return {
        key: dict(zip(part["object"], part["accuracy"], strict=True))
        for key, part in rows.groupby(["strategy", "draw"])
    }


def test_accuracies_stand_by_object_and_draw():
    table = arrange(CELLS)
    assert accuracies_by_draw(table, "paper") == {
        ("fixation", 0): {"a": 1.0, "b": 0.75},
        ("random", 0): {"a": 0.0, "b": 1.0},
        ("random", 2): {"a": 0.5, "b": 0.5},
        ("random", 10): {"b": 0.25},
        ("random_visible", 0): {"a": 0.5, "b": 0.0},
    }
    assert accuracies_by_draw(table, "literal") == {
        ("fixation", 0): {"a": 0.25, "b": 0.0},
        ("random", 0): {"a": 0.0, "b": 0.25},
    }


def test_an_object_has_its_weight_by_fixation_in_all_draws():
    fixation = ("default, first draw", "paper", "fixation", "support_vector_machine")
    weighted = {**CELLS, fixation: cell(1.0, objects=BOXES[1:], weights=[3.0])}
    rows = arrange(weighted).to_pandas().query("pipeline == 'paper'")
    assert set(rows["object"]) == {"b"}
    assert set(rows["weight"]) == {3.0}


def test_a_draw_that_failed_is_refused():
    failed = cell(objects=(), error="No viewpoint has 5 touches.")
    key = ("default, further draws", "paper", "random#3", "support_vector_machine")
    with pytest.raises(ReportError, match="random#3: No viewpoint has 5 touches"):
        arrange({**CELLS, key: failed})


def test_the_measured_table_is_kept_and_read_as_leads(tmp_path, monkeypatch):
    monkeypatch.setattr("draws.accuracies.read_cells", lambda blocks: CELLS)
    step = StepInputs("draws", {"blocks": []}, [tmp_path / "measured.parquet"], RUN)
    make_draws(step)
    keep(tmp_path / "measured.parquet", RUN.meshes.set, tmp_path)
    assert read_draws("paper", "paper", tmp_path).lead.leads == pytest.approx((0.375, 0.375, 0.5))
