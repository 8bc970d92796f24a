"""The presets are what the rule makes of the measured line, whoever wrote the file."""

import json

import numpy as np
import pytest
from studies.cost.test_front import cost_table

from visuohaptic.studies.cost.budgets import budgets, choose_budgets, write_budgets
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import COST


def test_a_larger_budget_takes_longer_and_errs_less():
    assert list(budgets()) == ["fast", "balanced", "accurate"]
    for name, sign in (("seconds", 1), ("error", -1)):
        assert (np.diff([sign * budget[name] for budget in budgets().values()]) > 0).all()


@pytest.mark.parametrize(
    ("errors", "viewpoints"),
    [
        # Balanced is the quickest at the geometric mean, 8 %.
        ({1: 0.16, 2: 0.09, 4: 0.08, 8: 0.05, 16: 0.04}, [1, 4, 16]),
        # What is slower and no better is never chosen.
        ({8: 0.06, 4: 0.05, 2: 0.05, 1: 0.2}, [1, 2, 2]),
        # No error counts as half the least one: of 16 % and 2 % the geometric mean is 5.7 %.
        ({1: 0.16, 2: 0.06, 4: 0.04, 8: 0.0}, [1, 4, 8]),
        ({1: 0.0, 2: 0.0}, [1, 1, 1]),
    ],
)
def test_budgets_follow_the_rule(errors, viewpoints):
    line = [{"viewpoints": n, "seconds": n / 10, "error": error} for n, error in errors.items()]
    assert [one["viewpoints"] for one in choose_budgets(line).values()] == viewpoints


def test_a_table_of_the_workflow_becomes_the_file(tmp_path):
    family = {"family": "viewpoints"}
    points = [("1 viewpoint", 0.1, 0.2, family), ("other", 0.1, 0.2), ("2", 0.2, 0.1, family)]
    write_table(COST, cost_table(points, failed=["8 × 8"]), tmp_path / "cost.parquet")
    write_budgets(tmp_path / "cost.parquet", tmp_path / "budgets.json", "two objects")
    held = json.loads((tmp_path / "budgets.json").read_text())
    assert held["measured_on"] == "two objects"
    assert [row["setting"] for row in held["line"]] == ["1 viewpoint", "2"]
    assert held["line"][1]["seconds"] == pytest.approx(0.2)
