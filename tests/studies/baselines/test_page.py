"""The page of the baselines says first what is ahead of ours, on objects that chose nothing."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

sys.path.append(str(Path(__file__).parents[3] / "docs"))

from baselines.choose import CHOSEN, GRIDS, LEVEL
from baselines.make_page import LABELS, blocks, difference, headline
from baselines.measure import (
    FOLDER,
    LENGTHS,
    OURS,
    STRATEGIES,
    KeptBaselines,
    KeptCell,
    arrange,
    read_kept,
)
from classifier_settings.choose import first_near_best
from visuohaptic.studies.keeping import Source, keep, kept_file, write_measured

OBJECTS = tuple(f"class/{number}" for number in range(20))


def kept(accuracies, choosing=()):
    """Keep the same accuracies for every strategy and length, by classifier."""
    cells = [
        KeptCell(
            classifier=name,
            strategy=strategy,
            touches=length,
            splits=1,
            accuracy=accuracies.get(name, [0.5] * len(OBJECTS)),
            weights=[1.0] * len(OBJECTS),
            fit=1.0,
            predict=1.0,
        )
        for name in LABELS
        for strategy in STRATEGIES
        for length in LENGTHS
    ]
    return KeptBaselines(Source("odd", "a", "b"), OBJECTS, choosing, cells)


def test_a_baseline_that_is_ahead_stands_first():
    ahead = headline({"paper": kept({"nearest_object": [0.9] * 20})})
    assert ahead.startswith(
        "**A baseline is significantly better than our pipeline at five touches**"
    )
    assert ahead.count("- nearest object") == ahead.count("+40.0 (+") == len(STRATEGIES)
    accuracies = {"nearest_object": [0.0] * 20, "touch_perceptron": [0.1] * 20, "paper": [0.0] * 20}
    accuracies["twenty_lines"] = [0.0] * 20
    behind = headline({"paper": kept(accuracies)})
    assert behind.startswith(
        "**No baseline is significantly better than our pipeline at five touches**"
    )
    assert behind.count("\n- ") == behind.count("- multilayer perceptron") == 1


def test_objects_that_chose_settings_and_objects_that_were_not_tested_do_not_count():
    accuracies = {"nearest_object": [1.0] * 10 + [0.25] * 9 + [None], OURS: [0.5] * 20}
    found = difference(kept(accuracies, OBJECTS[:10]), "nearest_object", "fixation", LENGTHS[0])
    assert found.mean == pytest.approx(-0.25)


def test_the_chosen_settings_are_the_simplest_of_the_best():
    assert first_near_best({"a": 0.5, "b": 0.7, "c": 0.7005, "d": 0.7002}, LEVEL) == "b"
    chosen = json.loads(CHOSEN.read_text())
    assert set(chosen) == set(GRIDS)
    for found in chosen.values():
        assert found["settings"] == json.loads(first_near_best(found["accuracy"], LEVEL))


@pytest.mark.parametrize(
    ("name", "objects", "choosing"), [("paper", 12, 0), ("benchmark", 142, 67)]
)
def test_every_cell_of_a_set_is_kept(name, objects, choosing):
    found = read_kept(name)
    assert (len(found.objects), len(found.choosing)) == (objects, choosing)
    assert {(one.classifier, one.strategy, one.touches) for one in found.cells} == {
        (classifier, strategy, length)
        for classifier in LABELS
        for strategy in STRATEGIES
        for length in LENGTHS
    }


def test_kept_cells_are_read_as_they_were_measured(tmp_path):
    cells = kept({"paper": [0.25] * 19 + [None]}).cells
    write_measured(arrange(cells, OBJECTS, OBJECTS[:3]), "paper", tmp_path / "baselines.parquet")
    keep(tmp_path / "baselines.parquet", "paper", tmp_path)
    found = read_kept("paper", tmp_path)
    assert (found.objects, found.choosing) == (OBJECTS, OBJECTS[:3])
    assert found.cells == cells
    assert found.source.set == "paper"


@pytest.mark.parametrize(("name", "count"), [("paper", "12 objects"), ("benchmark", "142 objects")])
def test_the_sentence_on_the_simplest_classifier_has_the_numbers_and_the_verdict_of_the_cells(
    name, count
):
    held = pd.read_parquet(kept_file(FOLDER, name)).dropna()
    held = held[(held["strategy"] == "random") & (held["touches"] == 5)]
    cells = {
        classifier: rows.set_index("object")[["accuracy", "weight"]]
        for classifier, rows in held.groupby("classifier")
    }
    means = [
        np.average(cells[key]["accuracy"], weights=cells[key]["weight"])
        for key in ("twenty_lines", "paper", OURS)
    ]
    (line,) = [
        " ".join(part.split())
        for part in blocks()["simplest"].split("\n- ")
        if part.removeprefix("- ").startswith(count)
    ]
    assert line.startswith(
        "{}: {:.1f} % by twenty lines, {:.1f} % by the paper's pipeline, {:.1f} % by ours.".format(
            count, *(100 * mean for mean in means)
        )
    )
    mean, low, high = (
        float(number.replace("\N{MINUS SIGN}", "-"))
        for number in re.search(r"(\S+) \((\S+) to (\S+)\) points", line).groups()
    )
    both = cells["twenty_lines"].add_suffix("_one").join(cells["paper"], how="inner")
    expected = np.average(both["accuracy_one"] - both["accuracy"], weights=both["weight"])
    assert mean == pytest.approx(100 * expected, abs=0.051)
    verdict = "ahead of" if low > 0 else "behind" if high < 0 else "not shown to differ from"
    assert f"Twenty lines are {verdict} the paper's: " in line
    assert low <= mean <= high
