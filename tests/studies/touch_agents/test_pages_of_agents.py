"""What the pages say of the kept figures is so: whom an agent has to beat, and what each difference compares."""

import re
import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[3] / "docs"))

from touch_agents import make_learning_page, make_page
from visuohaptic.studies.keeping import read_figures

FOLDER = Path(__file__).parents[3] / "studies/touch_agents"


def cell(frame, chooser, accuracy, loss):
    found = {
        name: {"objects": {"mean": mean, "low": mean - 0.1, "high": mean + 0.1}}
        for name, mean in (("accuracy", accuracy), ("loss", loss))
    }
    return {"frame": frame, "chooser": chooser, "predictor": "learned", "touches": 5, **found}


def test_adaptive_is_to_beat_only_where_an_agent_knows_as_much():
    best = make_page._best
    cells = [
        cell(frame, *values)
        for frame in ("full", "none")
        for values in (("adaptive", 0.8, 0.2), ("random", 0.6, 0.5), ("fixation", 0.5, 0.4))
    ]
    assert best(cells, "full") == "80.0 % (70–90) and a loss of 0.20 (0.10–0.30)"
    assert best(cells, "none") == "60.0 % (50–70) and a loss of 0.40 (0.30–0.50)"


def test_only_shown_differences_are_counted_and_a_lower_loss_is_better():
    rows = [
        {"measure": measure, "frame": frame, "chooser": "fixation", "corrected": corrected}
        | {"predictor": "learned", "comparison": {"difference": {"mean": mean}}}
        for measure, frame, mean, corrected in (
            ("accuracy", "full", 0.1, 0.01),
            ("accuracy", "none", -0.1, 0.01),
            ("loss", "full", -0.1, 0.2),
            ("loss", "centre", -0.1, 0.01),
            ("loss", "none", 0.1, 0.01),
        )
    ]
    assert make_page._better(rows) == "1 of 2 cases of accuracy and 1 of 3 cases of loss"
    assert make_page._leaders(rows) == "fixations in order, in `full` and `centre`"
    cells = [cell(frame, "random", 0.6, 0.5) for frame in ("full", "none")]
    assert make_page.answer(cells, rows).endswith("2 differences are shown to be worse.")


def test_each_difference_is_to_minus_from():
    table = make_learning_page.blocks()["differences"]
    rows = [line.strip("| ").split(" | ") for line in table.splitlines()[2:]]
    assert len(rows) == 8
    for _, _, begin, end, points, *_ in rows:
        first, last, gap = (
            float(re.match(r"\S+", text)[0].replace("\N{MINUS SIGN}", "-"))
            for text in (begin, end, points)
        )
        assert last - first == pytest.approx(gap, abs=0.16)


def test_training_gains_with_sight_is_not_shown_to_gain_without_and_their_difference_is_open():
    figures, _ = read_figures(FOLDER, "benchmark")
    answers = {}
    for row in figures["differences"]:
        answers.setdefault(row["name"], set()).add(row["answer"])
    assert answers["training with sight"] == {"yes"}
    assert "yes" not in answers["training without sight"]
    assert answers["sight in training"] == {"not settled"}
    said = " ".join((FOLDER / "learning.md").read_text(encoding="utf-8").split())
    assert "shown to gain with sight and not shown to gain without" in said
    assert "the difference of both gains is tested itself, and is not settled" in said
