"""Accuracies of turned objects that are kept with the package."""

import json

import pytest
from report.pages import plain

from visuohaptic.base.errors import ReportError
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.turned import POSES, TurnedSet, read_turned, turned_rows, turned_sentence


def cell(turns, strategy, accuracy, pipeline="paper"):
    named = {"turns": turns, "strategy": strategy, "pipeline": pipeline}
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
        "cells": [
            cell("any", "random", [0.5, None, 0.25]),
            cell("any", "fixation", [0.25, 0.75, 0.5]),
            cell("none", "random", [0.5, 0.5, 0.5], "order_free"),
            cell("none", "fixation", [1.0, 1.0, 1.0], "order_free"),
            cell("vertical", "fixation", [1.0, 1.0, 1.0], "order_free"),
        ],
    }
}


def test_rows_are_weighted_means_and_leads_over_the_objects_of_both_strategies(tmp_path):
    path = tmp_path / "turned.json"
    path.write_text(json.dumps(KEPT))
    first, second = turned_rows(read_turned(path)["paper"], IntervalParameters())
    assert (first.turns, first.pipeline, second.turns, second.pipeline) == (
        "none", "order_free", "any", "paper",
    )  # fmt: skip
    assert second.pose == POSES["any"]
    assert second.fixation.mean == pytest.approx((0.25 + 1.5 + 1.5) / 6)
    assert second.random.mean == pytest.approx((0.5 + 0.75) / 4)
    assert second.lead.mean == pytest.approx((-0.25 + 0.75) / 4)
    assert (second.objects, second.draws) == (2, 5)
    assert second.lead.low < second.lead.mean < second.lead.high


def test_the_leads_are_said_pose_by_pose():
    kept = TurnedSet.model_validate(KEPT["paper"])
    said = plain(turned_sentence(kept, IntervalParameters()))
    assert said.startswith(
        "Measured on 2026-11-26, on 2 objects: the lead over random places in reach is +12.5 points ("
    )
    assert said.endswith(") where they are turned in any way.")
    assert turned_sentence(kept, IntervalParameters(), "another") == ""


def test_a_damaged_file_is_named(tmp_path):
    path = tmp_path / "turned.json"
    path.write_text('{"paper": {"cells": 1}}')
    with pytest.raises(
        ReportError, match=r"turned\.json holds no kept accuracies of turned objects"
    ):
        read_turned(path)
    assert all(turned_rows(one, IntervalParameters()) for one in read_turned().values())
