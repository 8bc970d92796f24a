"""The page's means are those of the kept accuracies, counted again from the file."""

import json
from pathlib import Path

import pandas as pd

import visuohaptic.report
from visuohaptic.report.turned import KEPT, KNOWN, POSES, STRATEGIES

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "studies/turned/README.md").read_text(encoding="utf-8")
KEPT_SETS = json.loads(Path(visuohaptic.report.__file__).with_name(KEPT).read_text())


def mean_of(held, cell, tested):
    """Return the weighted mean of the objects that chose nothing and were tested by all strategies, and their number."""
    rows = pd.DataFrame(
        {"accuracy": cell["accuracy"], "weight": cell["weights"]},
        index=held["objects"],
        dtype=float,
    ).dropna()
    rows = rows[rows.index.isin(tested) & ~rows.index.isin(held["choosing"])]
    return (rows["accuracy"] * rows["weight"]).sum() / rows["weight"].sum(), len(rows)


def objects_of_all_strategies(held, cell):
    """Return the objects that all strategies tested in the pose, frame and number of touches of a cell."""
    names = ("turns", "known", "touches", "pipeline")
    alike = [one for one in held["cells"] if all(one[name] == cell[name] for name in names)]
    accuracies = pd.DataFrame([one["accuracy"] for one in alike], columns=held["objects"])
    return accuracies.dropna(axis=1).columns


def test_every_mean_by_frame_is_that_of_the_objects_that_report():
    compared = 0
    for held in KEPT_SETS.values():
        for cell in held["cells"]:
            if (cell["pipeline"], cell["touches"]) != ("order_free", 5):
                continue
            mean, objects = mean_of(held, cell, objects_of_all_strategies(held, cell))
            start = f"| {objects} | {POSES[cell['turns']]} | {KNOWN[cell['known']]} |"
            (line,) = [line for line in PAGE.splitlines() if line.startswith(start) and "(" in line]
            found = line.removeprefix(start).split("|")[STRATEGIES.index(cell["strategy"])]
            assert found.strip().startswith(f"{100 * mean:.1f} % (")
            compared += 1
    assert compared == 2 * 14 * len(STRATEGIES)


def test_the_half_that_chose_reports_nothing():
    chosen = json.loads((ROOT / "studies/classifier_settings/chosen.json").read_text())["half"]
    assert KEPT_SETS["benchmark"]["choosing"] == sorted(chosen)
    assert KEPT_SETS["paper"]["choosing"] == []
