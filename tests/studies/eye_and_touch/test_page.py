"""The page says of gains what the kept p values say, corrected by hand."""

import json
import re
from pathlib import Path

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
    bold = re.findall(r"\*\*([+−][\d.]+), p", PAGE)
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


def test_neither_page_nor_kept_file_has_an_interval_of_a_gain():
    assert not re.search(r"[+−]\d+\.\d \([+−]", PAGE)
    for figures in KEPT.values():
        gains = [gain for row in figures["sights"] for gain in row["gains"].values()]
        gains += [row["gain"] for row in figures["budgets"] if "gain" in row]
        assert all({*gain} == {"over", "difference", "p_value"} for gain in gains)
