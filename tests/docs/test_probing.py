"""The pages on places out of reach have the figures of the kept tables, counted with pandas."""

import re
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[2]
DEFAULT_RUN = ROOT / "tests/golden/kept/default_run/touches.parquet"


def words_of(page):
    return re.sub(r"\s+", " ", (ROOT / page).read_text(encoding="utf-8"))


def shares_of(touches):
    """Return the four shares in whole per cent, and the views in which the first fixation is never touched."""
    own = touches[touches["strategy"] == "fixation"].sort_values("touch")
    ranks = own.groupby(["class", "object", "viewpoint"])["rank"].agg(list)
    shares = {
        "as fixated": ranks.map(lambda view: view == [0, 1, 2, 3, 4]),
        "replaced": ranks.map(lambda view: any(rank >= 5 for rank in view)),
        "out of turn": own["rank"] != own["touch"],
        "elsewhere": own["rank"] >= 5,
    }
    missed = int(ranks.map(lambda view: 0 not in view).sum())
    return (
        {name: f"{100 * share.mean():.0f} %" for name, share in shares.items()},
        missed,
        len(ranks),
    )


def test_the_page_on_the_method_says_what_is_not_at_the_eyes_fixations():
    shares, missed, views = shares_of(pd.read_parquet(DEFAULT_RUN))
    text = words_of("docs/method.md")
    assert (
        f"only {shares['as fixated']} of the views of a default run are touched at exactly" in text
    )
    assert (
        f"{shares['out of turn']} of the touches are not at the fixation of the same number" in text
    )
    assert f"and {shares['elsewhere']} are at the sixth or a later fixation" in text
    assert f"In {missed} of {views} views the most salient place is never touched" in text
