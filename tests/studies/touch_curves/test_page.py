"""The pages say of the curves what the kept p values say, corrected by hand, and print both intervals."""

import json
import re
from itertools import product
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
STUDY = ROOT / "studies/touch_curves"


def words_of(page):
    return re.sub(r"\s+", " ", (ROOT / page).read_text(encoding="utf-8"))


def needed_of(name, pipeline):
    kept = json.loads((STUDY / f"kept_{name}.json").read_text())["figures"]["needed"][pipeline]
    rows = {strategy: next(iter(cell.values())) for strategy, cell in kept.items()}
    return {strategy: row for strategy, row in rows.items() if strategy != "fixation"}


def shown(name, pipeline):
    """Return the strategies that are ahead of fixation and behind it, with p below 0.05 after Holm's correction."""
    rows = needed_of(name, pipeline)
    ahead, behind, largest = set(), set(), 0.0
    for rank, strategy in enumerate(sorted(rows, key=lambda one: rows[one]["p_value"])):
        largest = max(largest, rows[strategy]["p_value"] * (len(rows) - rank))
        if largest < 0.05:
            (ahead if rows[strategy]["gain"] < 0 else behind).add(strategy)
    return ahead, behind


def test_the_strategies_that_differ_from_fixation_are_those_after_the_correction():
    page, probing = (
        words_of(name) for name in ("studies/touch_curves/README.md", "docs/probing.md")
    )
    ours, papers = shown("benchmark", "order_free"), shown("benchmark", "paper")
    assert ours == (set(), {"contour", "random_walk"})
    assert "In our pipeline no strategy is shown to be ahead of fixation" in page
    assert "Behind it are `contour` and `random_walk`." in page
    assert papers[0] == {"adaptive"}
    assert "Ahead of fixation is `adaptive`; behind are " in page
    (behind,) = re.findall(r"behind are ([^.]*)\.", page)
    assert {*re.findall(r"`(\w+)`", behind)} == papers[1]
    assert (
        "no strategy is shown to be ahead of fixation in our pipeline, and only `adaptive`"
        in probing
    )


def test_no_strategy_differs_from_fixation_on_few_objects():
    tested = [needed_of("paper", pipeline) for pipeline in ("order_free", "paper")]
    assert [*map(len, tested)] == [9, 9]
    assert {shown("paper", name) == (set(), set()) for name in ("order_free", "paper")} == {True}
    assert "On the paper's 12 objects 0 of 18 areas differ" in words_of(
        "studies/touch_curves/README.md"
    )
    assert "On the paper's twelve objects none is shown to differ" in words_of("docs/probing.md")


@pytest.mark.parametrize("name", ["paper", "benchmark"])
@pytest.mark.parametrize("pipeline", ["order_free", "paper"])
def test_an_interval_excludes_equal_areas_exactly_if_its_p_value_is_small(name, pipeline):
    for row, population in product(needed_of(name, pipeline).values(), ("", "_new_classes")):
        low, high = (row[f"gain{population}_{end}"] for end in ("low", "high"))
        assert (low > 0 or high < 0) == (row[f"p_value{population}"] < 0.05)


@pytest.mark.parametrize("pipeline", ["order_free", "paper"])
def test_the_table_has_both_intervals_of_each_difference_of_areas(pipeline):
    page = words_of("studies/touch_curves/README.md")
    for row in needed_of("benchmark", pipeline).values():
        ends = "; ".join(
            " to ".join(f"{100 * row[f'gain{population}_{end}']:+.1f}" for end in ("low", "high"))
            for population in ("", "_new_classes")
        )
        assert f"({ends})".replace("-", "−") in page


def test_leads_without_an_interval_have_none_on_their_page():
    assert not re.search(r"[+−]\d+\.\d \([+−]", words_of("studies/variants/README.md"))
