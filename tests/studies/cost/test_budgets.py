"""The presets are what the rule makes of the measured line, whoever wrote the file."""

import json
from importlib.resources import files

import pytest
from studies.cost.test_front import cost_table

from visuohaptic.studies.cost.budgets import budgets, choose_budgets, write_budgets
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.studies import COST

HELD = json.loads(files("visuohaptic.studies.cost").joinpath("budgets.json").read_text("utf-8"))


def line(*points):
    return [
        {"viewpoints": viewpoints, "seconds": seconds, "error": error, "objects": 50}
        for viewpoints, seconds, error in points
    ]


def chosen(*points):
    return {name: one.viewpoints for name, one in choose_budgets(line(*points)).items()}


def test_the_file_holds_what_the_rule_makes_of_its_own_line():
    derived = choose_budgets(HELD["line"])
    assert derived == budgets()
    seconds = [budget.seconds for budget in derived.values()]
    assert seconds == sorted(seconds)
    errors = [budget.error for budget in derived.values()]
    assert errors == sorted(errors, reverse=True)


def test_balanced_is_the_quickest_at_the_geometric_mean():
    points = [(1, 0.1, 0.16), (2, 0.2, 0.09), (4, 0.4, 0.08), (8, 0.8, 0.05), (16, 1.6, 0.04)]
    assert chosen(*points) == {"fast": 1, "balanced": 4, "accurate": 16}


def test_what_is_slower_and_no_better_is_never_chosen():
    points = [(1, 0.1, 0.2), (2, 0.2, 0.05), (4, 0.4, 0.05), (8, 0.8, 0.06)]
    assert chosen(*points) == {"fast": 1, "balanced": 2, "accurate": 2}


def test_no_error_counts_as_half_the_least_one():
    # The geometric mean of 16 % and of 2 % (half of 4 %) is 5.7 %.
    points = [(1, 0.1, 0.16), (2, 0.2, 0.06), (4, 0.4, 0.04), (8, 0.8, 0.0)]
    assert chosen(*points) == {"fast": 1, "balanced": 4, "accurate": 8}
    assert set(chosen((1, 0.1, 0.0), (2, 0.2, 0.0)).values()) == {1}


def test_a_single_setting_is_every_budget():
    assert set(chosen((4, 0.1, 0.3)).values()) == {4}


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
