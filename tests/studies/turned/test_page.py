"""The page's means are those of the kept accuracies, counted again from the file."""

import json
from pathlib import Path

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


def test_every_mean_by_frame_is_that_of_the_held_out_objects():
    compared = 0
    for kept in KEPT_SETS.values():
        of_ours = kept[(kept["pipeline"] == "order_free") & (kept["touches"] == 5)]
        for (turns, known, *_), rows in of_ours.groupby(NAMES):
            tested = objects_of_all_strategies(rows)
            for strategy, measured in rows.groupby("strategy"):
                cell = measured.set_index(["class", "object"]).loc[tested]
                mean = (cell["accuracy"] * cell["weight"]).sum() / cell["weight"].sum()
                start = f"| {len(cell)} | {POSES[turns]} | {KNOWN[known]} |"
                (line,) = [
                    line for line in PAGE.splitlines() if line.startswith(start) and "(" in line
                ]
                found = line.removeprefix(start).split("|")[STRATEGIES.index(strategy)]
                assert found.strip().startswith(f"{100 * mean:.1f} % (")
                compared += 1
    assert compared == 2 * 14 * len(STRATEGIES)


def test_the_half_that_chose_is_not_held_out():
    chosen = json.loads((ROOT / "studies/classifier_settings/chosen.json").read_text())["half"]
    for name, choosing in (("benchmark", sorted(chosen)), ("paper", [])):
        rows = KEPT_SETS[name][~KEPT_SETS[name]["held_out"]]
        assert sorted(set(rows["class"] + "/" + rows["object"])) == choosing
