"""The page's means are those of the kept accuracies, counted again from the file."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd

from turned.kept import KNOWN
from turned.study import STRATEGIES
from visuohaptic.report.wording import POSES

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "studies/turned/README.md").read_text(encoding="utf-8")
KEPT_SETS = {
    name: pd.read_parquet(ROOT / f"studies/turned/kept_{name}.parquet")
    for name in ("paper", "benchmark")
}
NAMES = ["turns", "known", "touches", "pipeline"]


def objects_of_all_strategies(rows):
    """Return the held-out objects that all strategies tested, of rows with one pose, frame and number of touches."""
    held_out = rows[rows["held_out"]]
    counts = held_out.groupby(["class", "object"])["strategy"].nunique()
    return counts.index[counts == rows["strategy"].nunique()]


def means_by_frame(kept):
    """Return the number of objects and the mean accuracy by pose, known frame and strategy, counted from kept rows."""
    of_ours = kept[(kept["pipeline"] == "order_free") & (kept["touches"] == 5)]
    means = {}
    for (turns, known, *_), rows in of_ours.groupby(NAMES):
        tested = objects_of_all_strategies(rows)
        for strategy, measured in rows.groupby("strategy"):
            cell = measured.set_index(["class", "object"]).loc[tested]
            mean = (cell["accuracy"] * cell["weight"]).sum() / cell["weight"].sum()
            shown = KNOWN[known].partition(", fitted")[0]
            means[POSES[turns], shown, strategy] = len(cell), 100 * mean
    return means


def test_every_mean_by_frame_is_that_of_the_held_out_objects():
    few, many = (means_by_frame(KEPT_SETS[name]) for name in ("paper", "benchmark"))
    block = re.search(r"<!-- frames -->\n(.*)<!-- /frames -->", PAGE, re.S)[1]
    _, _, *lines = ([cell.strip() for cell in line.split("|")[1:-1]] for line in block.splitlines())
    assert len(lines) == 7
    assert len({pose + known for pose, known, *_ in lines}) == 7
    for pose, known, *cells in lines:
        expected = [means[pose, known, "fixation"] for means in (many, few)]
        assert [cell.partition(" (")[0] for cell in cells] == [
            f"{mean:.1f} %" for _, mean in expected
        ]
        assert [count for count, _ in expected] == [75, 12]


def test_the_fall_in_the_papers_pipeline_is_that_of_all_objects():
    said = " ".join(re.search(r"<!-- turned -->\n(.*)<!-- /turned -->", PAGE, re.S)[1].split())
    chosen = {"pipeline": "paper", "known": "full", "touches": 5}
    means = []
    for kept in (KEPT_SETS["benchmark"], KEPT_SETS["paper"]):
        cells = kept[(kept[list(chosen)] == pd.Series(chosen)).all(axis=1)]
        for turns in POSES:
            rows = cells[cells["turns"] == turns]
            rows = rows.set_index(["class", "object"])
            tested = rows.groupby(level=[0, 1])["strategy"].nunique() == len(STRATEGIES)
            rows = rows[rows["strategy"] == "fixation"].loc[tested[tested].index]
            means.append(f"{100 * np.average(rows['accuracy'], weights=rows['weight']):.1f} %")
    assert re.findall(r"\d+\.\d %", said) == means


def test_the_objects_of_the_picture_have_sequences_of_all_lengths():
    kept = KEPT_SETS["benchmark"]
    drawn = kept[kept["held_out"] & (kept["pipeline"] == "order_free")]
    longer = drawn[drawn["touches"] == 20][["turns", "known"]].drop_duplicates()
    rows = drawn.merge(longer)
    counts = rows.groupby(["class", "object"]).size()
    whole = rows.groupby(["turns", "known", "touches", "strategy"]).ngroups
    assert f"{(counts == whole).sum()} of the 75 held-out objects" in " ".join(PAGE.split())


def test_the_half_that_chose_is_not_held_out():
    chosen = json.loads((ROOT / "studies/classifier_settings/chosen.json").read_text())["half"]
    for name, choosing in (("benchmark", sorted(chosen)), ("paper", [])):
        rows = KEPT_SETS[name][~KEPT_SETS[name]["held_out"]]
        assert sorted(set(rows["class"] + "/" + rows["object"])) == choosing
