"""The presets are what the rule makes of the measured line, whoever wrote the file."""

import json
from importlib.resources import files

import numpy as np
import pytest
from studies.cost.test_front import cost_table

from visuohaptic.studies.cost.budgets import budgets, choose_budgets, write_budgets
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import COST

HELD = json.loads(files("visuohaptic.studies.cost").joinpath("budgets.json").read_text("utf-8"))


def test_the_file_holds_what_the_rule_makes_of_its_own_line():
    derived = choose_budgets(HELD["line"])
    assert derived == budgets()
    for name, sign in (("seconds", 1), ("error", -1)):
        assert (np.diff([sign * budget[name] for budget in derived.values()]) >= 0).all()


@pytest.mark.parametrize(
    ("points", "viewpoints"),
    [
        pytest.param(
            [(1, 0.1, 0.16), (2, 0.2, 0.09), (4, 0.4, 0.08), (8, 0.8, 0.05), (16, 1.6, 0.04)],
            [1, 4, 16],
            id="balanced is the quickest at the geometric mean",
        ),
        pytest.param(
            [(8, 0.8, 0.06), (4, 0.4, 0.05), (2, 0.2, 0.05), (1, 0.1, 0.2)],
            [1, 2, 2],
            id="what is slower and no better is never chosen",
        ),
        pytest.param(
            # The geometric mean of 16 % and of 2 % (half of 4 %) is 5.7 %.
            [(1, 0.1, 0.16), (2, 0.2, 0.06), (4, 0.4, 0.04), (8, 0.8, 0.0)],
            [1, 4, 8],
            id="no error counts as half the least one",
        ),
        pytest.param([(1, 0.1, 0.0), (2, 0.2, 0.0)], [1, 1, 1], id="no error at all"),
        pytest.param([(4, 0.1, 0.3)], [4, 4, 4], id="a single setting is every budget"),
    ],
)
def test_budgets_follow_the_rule(points, viewpoints):
    line = [dict(zip(("viewpoints", "seconds", "error"), one, strict=True)) for one in points]
    assert [one["viewpoints"] for one in choose_budgets(line).values()] == viewpoints


def test_a_table_of_the_workflow_becomes_the_file(tmp_path):
    table = cost_table([("1 viewpoint", 0.1, 0.2), ("2 viewpoints", 0.2, 0.1)], failed=["8 × 8"])
    place = table.schema.get_field_index("family")
    table = table.set_column(place, table.schema.field("family"), [["viewpoints"] * 3])
    write_table(COST, table, tmp_path / "cost.parquet")
    write_budgets(tmp_path / "cost.parquet", tmp_path / "budgets.json", "two objects")
    held = json.loads((tmp_path / "budgets.json").read_text())
    assert held["measured_on"] == "two objects"
    assert len(held["line"]) == 2
    assert held["budgets"]["accurate"]["seconds"] == pytest.approx(0.2)
