"""The sentences on the first touch say what the kept table says, recomputed with pandas."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from visuohaptic.attention.registry import CHANNELS
from visuohaptic.report.wording import listed

ROOT = Path(__file__).parents[3]
PAGES = (ROOT / "docs/two_questions.md",)


def text_of(page):
    block = re.search(r"<!-- first touch -->\n(.*?)<!-- /first touch -->", page.read_text(), re.S)[
        1
    ]
    return " ".join(block.split()).replace("\N{MINUS SIGN}", "-")


def upright_with(known):
    """Return the kept rows of upright objects in our pipeline, with a known part of the pose."""
    kept = pd.read_parquet(ROOT / "studies/first_touch/kept_benchmark.parquet")
    setting = {"pipeline": "order_free", "turns": "none", "known": known, "looking": "default"}
    return kept[(kept[list(setting)] == pd.Series(setting)).all(axis=1)]


@pytest.fixture(scope="module")
def rows():
    return upright_with("full")


def by_object(rows, strategy, touches):
    chosen = rows[(rows["strategy"] == strategy) & (rows["touches"] == touches)]
    return chosen.groupby("object")[["accuracy", "weight"]].mean()


def lead(rows, first, second, touches):
    """Return the lead in points, and whether sign changes reject a lead of 0."""
    one, other = (by_object(rows, strategy, touches) for strategy in (first, second))
    terms = ((one["accuracy"] - other["accuracy"]) * one["weight"] / one["weight"].sum()).dropna()
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(20_000, len(terms)))
    p = np.mean(np.abs(signs @ terms.to_numpy()) >= abs(terms.sum()) - 1e-12)
    return 100 * terms.sum(), p < 0.05


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_sentences_have_the_numbers_and_words_of_the_table(page, rows):
    said = text_of(page)
    human = by_object(rows, "human", 1)
    right = 100 * np.average(human["accuracy"], weights=human["weight"])
    assert f"{right:.1f} % of the views are right in our pipeline" in said
    gaze, is_ahead = lead(rows, "human", "random_visible", 1)
    assert is_ahead
    assert gaze > 0
    assert "Yes, on upright objects that face a known way." in said
    assert f"the lead over random places in sight is {gaze:+.1f} points (" in said
    highest, differs = lead(rows, "human", "highest", 1)
    assert not differs
    assert f"does as well, as far as is shown (lead over it {highest:+.1f} points" in said
    channels, help_ = lead(rows, "gaze_channels", "random_visible", 1)
    assert not help_
    assert f"by themselves do not help ({channels:+.1f} points" in said
    later, stands = lead(rows, "human", "random_visible", 2)
    assert not stands
    assert f"With two touches the lead is no longer shown ({later:+.1f} points" in said
    front, is_shown = lead(upright_with("vertical"), "human", "random_visible", 1)
    assert not is_shown
    assert f"with one touch and an unknown front it is not shown ({front:+.1f} points" in said


def test_the_readme_has_the_lead_of_the_table(rows):
    said = " ".join((ROOT / "README.md").read_text().split())
    gaze, is_ahead = lead(rows, "human", "random_visible", 1)
    assert is_ahead
    assert f"{gaze:+.1f} points over a random place in sight in our pipeline" in said
    shown = {
        part: lead(rows, part, "random_visible", 1)[1]
        for part in ("gaze_place", "gaze_shape", "gaze_channels")
    }
    assert shown == {"gaze_place": True, "gaze_shape": True, "gaze_channels": False}
    assert "by the model's terms for place and shape, not by saliency" in said
    assert not lead(rows, "human", "highest", 1)[1]
    assert not lead(rows, "human", "random_visible", 2)[1]
    assert not lead(upright_with("vertical"), "human", "random_visible", 1)[1]
    assert (
        "With two touches, or with an unknown front, no lead over a random place is shown." in said
    )


def test_the_turned_leads_that_stand_are_bold_in_the_table():
    text = (ROOT / "studies/first_touch/README.md").read_text()
    table = re.search(r"<!-- leads -->\n(.*?)<!-- /leads -->", text, re.S)[1]
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()[2:]]
    bold = [row for row in cells if row[0] != "upright" and row[3].startswith("**+")]
    said = re.search(r"there (\d+) stand ahead after Holm's", " ".join(text.split()))
    assert not bold
    assert said[1] == "0"


def test_random_places_have_five_draws(rows):
    drawn = rows[(rows["strategy"] == "random_visible") & (rows["touches"] == 1)]
    assert drawn["places"].nunique() == 5
    assert drawn["object"].nunique() == 142


def test_the_page_has_the_leads_of_single_channels_and_names_those_that_were_not_measured():
    kept = pd.read_parquet(ROOT / "studies/first_touch/kept_benchmark.parquet")
    kept = kept[(kept["touches"] == 1) & (kept["known"] == "full")]
    said = " ".join((ROOT / "studies/first_touch/README.md").read_text().split())
    said = said.replace("\N{MINUS SIGN}", "-")
    measured = [name for name in kept["looking"].unique() if name != "default"]
    for pipeline, words in (("order_free", "our pipeline"), ("paper", "the paper's pipeline")):
        rows = kept[kept["pipeline"] == pipeline]
        sight = rows[rows["strategy"] == "random_visible"].assign(touches=1)
        leads = [
            lead(
                pd.concat([rows[rows["looking"] == name], sight]), "fixation", "random_visible", 1
            )[0]
            for name in measured
        ]
        assert f"{min(leads):+.1f} to {max(leads):+.1f} points in {words} (" in said
        assert f"of {len(measured)} ahead" in said
    missing = [name for name in CHANNELS if name not in measured]
    assert ("were measured on these objects only" in said) == bool(missing)
    assert not missing or f"Single channels {listed(missing)} were measured" in said
