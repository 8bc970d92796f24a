"""The pages on places out of reach have the figures of the kept tables, counted with pandas."""

import json
import re
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[2]
DEFAULT_RUN = ROOT / "tests/golden/kept/default_run/touches.parquet"


def words_of(page):
    return re.sub(r"\s+", " ", (ROOT / page).read_text(encoding="utf-8"))


def shares_of(touches, decimals=0):
    """Return three shares in per cent, and the views in which the first fixation is never touched."""
    own = touches[touches["strategy"] == "fixation"].sort_values("touch")
    ranks = own.groupby(["class", "object", "viewpoint"])["rank"].agg(list)
    shares = {
        "as fixated": ranks.map(lambda view: view == [0, 1, 2, 3, 4]),
        "out of turn": own["rank"] != own["touch"],
        "elsewhere": own["rank"] >= 5,
    }
    missed = int(ranks.map(lambda view: 0 not in view).sum())
    return (
        {name: f"{100 * share.mean():.{decimals}f} %" for name, share in shares.items()},
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


def cells(line):
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_the_page_on_probing_has_the_shares_of_the_kept_ranks():
    ranks = pd.read_parquet(ROOT / "docs/figures/ranks.parquet")
    default = pd.read_parquet(DEFAULT_RUN)
    default = default[default["strategy"] == "fixation"]
    keys = ["class", "object", "viewpoint", "touch", "rank"]
    own = ranks[ranks["set"] == "paper"]
    assert sorted(map(tuple, own[keys].to_numpy())) == sorted(map(tuple, default[keys].to_numpy()))
    by_set = [shares_of(ranks[ranks["set"] == name], 1)[0] for name in ("paper", "benchmark")]
    text = (ROOT / "docs/probing.md").read_text(encoding="utf-8")
    block = text.split("<!-- shares -->")[1].split("<!-- /shares -->")[0].strip().splitlines()
    assert [cells(line)[1:] for line in block[2:]] == [
        [shares[name] for shares in by_set] for name in ("as fixated", "out of turn", "elsewhere")
    ]


def test_the_page_on_probing_has_the_accuracies_of_the_kept_study():
    text = (ROOT / "docs/probing.md").read_text(encoding="utf-8")
    block = text.split("<!-- accuracies -->")[1].split("<!-- /accuracies -->")[0].strip()
    shown = [cells(line)[1:] for line in block.splitlines()[2:]]
    expected = []
    kept, small = (
        json.loads((ROOT / f"docs/figures/out_of_reach_{name}.json").read_text())["figures"]
        for name in ("benchmark", "paper")
    )
    for condition in ("as run", "skip", "keep"):
        row = []
        for pipeline, classifier in (
            ("paper", "support_vector_machine"),
            ("order_free", "linear_discriminant"),
        ):
            fixation, random = (
                kept[pipeline][strategy][classifier][condition]
                for strategy in ("fixation", "random_visible")
            )
            lead = 100 * (fixation["accuracy"] - random["accuracy"])
            row += [f"{100 * fixation['accuracy']:.1f} %", lead]
            for population in ("", "_new_classes"):
                low, high = (random[f"lead{population}_{end}"] for end in ("low", "high"))
                assert (low > 0 or high < 0) == (random[f"lead_p{population}"] < 0.05)
                assert f"{100 * low:+.1f} to {100 * high:+.1f}".replace("-", "−") in block
            of_small = small[pipeline]["random_visible"][classifier][condition]
            assert of_small["lead_p"] >= 0.05
        expected.append(row)
    assert "Twelve objects cannot tell: no lead has p below 0.05." in text
    assert len(shown) == len(expected) == 3
    for line, row in zip(shown, expected, strict=True):
        for cell, value in zip(line, row, strict=True):
            if isinstance(value, str):
                assert cell == value
            else:
                number = float(cell.split(" (")[0].strip("*").replace("\N{MINUS SIGN}", "-"))
                # Pairs leave out objects that one strategy lacks; both figures are rounded.
                assert abs(number - value) < 0.2
