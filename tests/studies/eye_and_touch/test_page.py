"""The page says of gains what the kept p values say, corrected by hand, and prints both intervals."""

import json
import re
from itertools import product
from pathlib import Path

import pytest

STUDY = Path(__file__).parents[3] / "studies/eye_and_touch"
PAGE = " ".join((STUDY / "README.md").read_text(encoding="utf-8").split())
KEPT = {
    name: json.loads((STUDY / f"kept_{name}.json").read_text())["figures"]
    for name in ("paper", "benchmark")
}


def after_holm(gains):
    """Return the gains with p below 0.05 after Holm's correction: 1 ahead, -1 behind, 0 not shown."""
    largest, sides = 0.0, {}
    for rank, name in enumerate(sorted(gains, key=lambda one: gains[one]["p_value"])):
        largest = max(largest, gains[name]["p_value"] * (len(gains) - rank))
        difference = gains[name]["difference"]
        sides[name] = (difference > 0) - (difference < 0) if largest < 0.05 else 0
    return sides


def test_touch_is_ahead_of_a_look_in_every_sight_and_both_senses_behind_with_a_board():
    sights = KEPT["benchmark"]["sights"]
    gains = {
        (row["sight"], answer): row["gains"][answer]
        for row in sights
        for answer in ("touch", "checked product")
    }
    sides = after_holm(gains)
    assert {sides[row["sight"], "touch"] for row in sights} == {1}
    assert "five touches where the eye fixates are ahead of a look in every sight" in PAGE
    behind = [sight for (sight, answer), side in sides.items() if side < 0]
    assert behind == ["occluded"]
    assert sides["clean", "checked product"] == 0
    assert "Both senses together are not shown to be better than touch in clean sight" in PAGE
    bold = re.findall(r"\*\*([+−][\d.]+)\*\* \(", PAGE)
    assert len(bold) == sum(side != 0 for side in sides.values()) == 7


def test_the_stopping_rule_is_counted_after_the_correction():
    rows = {
        (row["budget"], row["strategy"]): row["gain"]
        for row in KEPT["benchmark"]["budgets"]
        if row["answer"] == "stopping"
    }
    sides = after_holm(rows)
    for budget, shown in ((5, 4), (10, 4), (20, 3), (40, 0)):
        assert sum(side == 1 for (own, _), side in sides.items() if own == budget) == shown
        assert re.search(rf"at {budget} s \(shown for {shown} of 4 strategies", PAGE)


@pytest.mark.parametrize("name", KEPT)
def test_an_interval_excludes_no_gain_exactly_if_its_p_value_is_small(name):
    figures = KEPT[name]
    gains = [gain for row in figures["sights"] for gain in row["gains"].values()]
    gains += [row["gain"] for row in figures["budgets"] if "gain" in row]
    for gain, population in product(gains, ("", "_new_classes")):
        low, high = (gain[f"difference{population}_{end}"] for end in ("low", "high"))
        assert (low > 0 or high < 0) == (gain[f"p_value{population}"] < 0.05)


def test_the_table_has_both_intervals_of_each_gain():
    for row in KEPT["benchmark"]["sights"]:
        for answer in ("touch", "checked product"):
            gain = row["gains"][answer]
            ends = "; ".join(
                " to ".join(
                    f"{100 * gain[f'difference{population}_{end}']:+.1f}" for end in ("low", "high")
                )
                for population in ("", "_new_classes")
            )
            assert f"({ends})".replace("-", "−") in PAGE
