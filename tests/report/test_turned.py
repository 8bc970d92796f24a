"""Accuracies of turned objects that are kept with the package."""

import json

import pytest
from report.pages import plain

from visuohaptic.base.errors import ReportError
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.draws import read_draws
from visuohaptic.report.turned import (
    POSES,
    STRATEGIES,
    CellName,
    TurnedSet,
    contrast,
    curve_rows,
    frame_rows,
    more_objects_sentences,
    read_turned,
    turned_rows,
    turned_sentence,
    unknown_pose_sentence,
)
from visuohaptic.report.wording import points


def cell(turns, strategy, accuracy, pipeline="paper", known="full", touches=5):
    named = {
        "turns": turns, "strategy": strategy, "pipeline": pipeline, "known": known, "touches": touches,
    }  # fmt: skip
    weights = [None if one is None else 1.0 + place for place, one in enumerate(accuracy)]
    return {
        **named, "classifier": "support_vector_machine", "draws": 5, "accuracy": accuracy,
        "weights": weights,
    }  # fmt: skip


KEPT = {
    "paper": {
        "commit": "0123456789abcdef",
        "date": "2026-11-26",
        "objects": ["box/a", "box/b", "cup/c"],
        "choosing": ["cup/c"],
        "cells": [
            cell("any", "random", [0.5, None, 0.25]),
            cell("any", "fixation", [0.25, 0.75, 0.5]),
            cell("any", "random_visible", [0.5, 0.5, 0.5]),
            cell("none", "random", [0.5, 0.5, 0.5], "order_free"),
            cell("none", "random_visible", [0.75, 0.5, 0.5], "order_free"),
            cell("none", "fixation", [1.0, 1.0, 1.0], "order_free"),
            cell("vertical", "fixation", [1.0, 1.0, 1.0], "order_free"),
            cell("any", "random", [0.25, 0.25, 1.0], "order_free", "none"),
            cell("any", "random_visible", [0.5, 0.5, 1.0], "order_free", "none"),
            cell("any", "fixation", [0.5, 1.0, 0.0], "order_free", "none"),
            cell("any", "fixation", [0.0, 0.0, 0.0], "order_free", "none", 20),
        ],
    }
}


def test_rows_are_weighted_means_and_leads_over_the_objects_of_all_strategies(tmp_path):
    path = tmp_path / "turned.json"
    path.write_text(json.dumps(KEPT))
    first, second = turned_rows(read_turned(path)["paper"], IntervalParameters())
    assert (first.turns, first.pipeline, second.turns, second.pipeline) == (
        "none", "order_free", "any", "paper",
    )  # fmt: skip
    assert second.pose == POSES["any"]
    assert second.fixation.mean == pytest.approx((0.25 + 1.5) / 4)
    assert second.random.mean == pytest.approx((0.5 + 0.75) / 4)
    assert second.lead.mean == pytest.approx((-0.25 + 0.75) / 4)
    assert (second.objects, second.draws) == (2, 5)
    assert second.lead.low < second.lead.mean < second.lead.high
    assert second.salience.mean == pytest.approx(-0.25 / 4)


def test_frames_are_compared_on_the_objects_that_chose_nothing():
    kept = TurnedSet.model_validate(KEPT["paper"])
    assert kept.reports.tolist() == [True, True, False]
    upright, unknown = frame_rows(kept, IntervalParameters())
    assert (upright.known, unknown.known, unknown.objects) == ("full", "none", 2)
    assert unknown.fixation.mean == pytest.approx((0.5 + 2 * 1.0) / 3)
    assert unknown.lead.mean == pytest.approx((0.25 + 2 * 0.75) / 3)
    assert unknown.salience.mean == pytest.approx((0.0 + 2 * 0.5) / 3)


def test_a_curve_has_the_objects_that_have_sequences_of_all_lengths():
    cells = [
        cell("any", strategy, values, "order_free", "none", touches)
        for strategy in STRATEGIES
        for touches, values in ((5, [0.5, 1.0, 0.5]), (20, [1.0, None, 1.0]))
    ]
    kept = TurnedSet.model_validate(KEPT["paper"] | {"choosing": [], "cells": cells})
    short, long = curve_rows(kept, IntervalParameters())
    assert (short.touches, long.touches) == (5, 20)
    assert (short.objects, long.objects) == (2, 2)
    assert (short.fixation.mean, long.fixation.mean) == (0.5, 1.0)
    only_short = kept.model_copy(update={"cells": kept.cells[::2]})
    assert curve_rows(only_short, IntervalParameters()) == []


def test_a_change_of_a_lead_is_a_contrast_of_four_cells_over_the_same_objects():
    kept = TurnedSet.model_validate(KEPT["paper"])
    unknown, known = ("any", "none", 5), ("none", "full", 5)
    plus = [CellName(*unknown, "fixation"), CellName(*known, "random")]
    minus = [CellName(*unknown, "random"), CellName(*known, "fixation")]
    found = contrast(kept, plus, minus, IntervalParameters())
    assert found.mean == pytest.approx((-0.25 + 2 * 0.25) / 3)
    assert -2 <= found.low < found.mean < found.high <= 2
    with pytest.raises(ReportError, match="is kept for any centre 5 random"):
        contrast(kept, [CellName("any", "centre", 5, "random")], [], IntervalParameters())


def test_what_an_unknown_pose_changes_is_said_for_both_kinds_of_random_places():
    kept = TurnedSet.model_validate(KEPT["paper"])
    said = plain(unknown_pose_sentence(kept, IntervalParameters()))
    assert said.startswith(
        "If objects are turned in any way and their pose is unknown, instead of upright with a known pose, the lead in "
        "pipeline order_free changes by +8.3 points ("
    )
    assert ") over random places in reach and by −8.3 points (" in said
    assert said.endswith(") over random places in sight (2 held-out objects).")


def test_the_leads_of_turned_objects_are_said_pose_by_pose():
    kept = TurnedSet.model_validate(KEPT["paper"])
    said = plain(turned_sentence(kept, IntervalParameters()))
    assert said.startswith(
        "With 2 turned objects the lead in the paper's pipeline is +12.5 points ("
    )
    assert said.endswith(") (turned in any way), over random places in reach.")


def test_the_lead_of_upright_objects_has_a_sign_only_where_its_interval_excludes_zero():
    kept = TurnedSet.model_validate(KEPT["paper"])
    [said] = map(plain, more_objects_sentences(kept, IntervalParameters()))
    assert said.startswith(
        "With 3 objects no lead is shown in pipeline order_free: +50.0 points (−"
    )
    assert said.endswith(") over random places in reach (measured on 2026-11-26).")


def test_the_lead_of_upright_objects_has_the_ends_of_its_draws_beside():
    kept = read_turned()["benchmark"]
    drawn = [read_draws("benchmark", name) for name in ("paper", "order_free")]
    own, ours = map(plain, more_objects_sentences(kept, IntervalParameters(), drawn))
    ends = f"{points(min(drawn[0].lead.leads))} to {points(max(drawn[0].lead.leads))}"
    assert own.startswith("With 142 objects fixation leads in the paper's pipeline: +")
    assert f" over random places in reach; 20 draws of the places give {ends} (" in own
    assert ours.startswith("With 142 objects no lead is shown in pipeline order_free: −")


def test_a_damaged_file_is_named(tmp_path):
    path = tmp_path / "turned.json"
    path.write_text('{"paper": {"cells": 1}}')
    with pytest.raises(
        ReportError, match=r"turned\.json holds no kept accuracies of turned objects"
    ):
        read_turned(path)
    assert all(turned_rows(one, IntervalParameters()) for one in read_turned().values())
