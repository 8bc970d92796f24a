"""The section on certainty shows what was measured, and names the command where nothing was."""

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.certainty import certainty_figures
from visuohaptic.studies.certainty import summarise_certainty
from visuohaptic.studies.figures import write_json
from visuohaptic.tables.schema import build_table, write_table
from visuohaptic.tables.studies import CERTAINTY, EVALUATION, STATED_COVERAGES


def certainty_table(fits=(0.05, 0.15, 0.45, 0.95), strange=(0.25, 0.65, 0.95, 1.0), candidates=1):
    """Give two strategies that name each of `fits` known and of `strange` unknown objects by 4 views."""
    rows = [
        {
            "strategy": strategy, "classifier": "naive_bayes", "left_out": left_out,
            "class": left_out if not known else "cup", "object": f"{known}{place}", "views": 4,
            "known": known, "correct": known, "covered": known and value > 0.1,
            "covered_at": [stated for stated in STATED_COVERAGES if known and value > 1 - stated / 100 + 1e-12],
            "candidates": candidates,
            "strangeness": 0.35 if known else value, "evidence": 0.35 if known else value,
            "unknown": not known and value > 0.9,
        }
        for strategy in ("fixation", "random")
        for left_out in ("ball", "box", "can")
        for known, values in ((True, fits), (False, strange))
        for place, value in enumerate(values)
    ]  # fmt: skip
    return build_table(CERTAINTY, {name: [row[name] for row in rows] for name in rows[0]})


def write_certainty(folder, **columns):
    """Write the table and its figures where the workflow does."""
    table = certainty_table(**columns)
    write_table(CERTAINTY, table, folder / "results/certainty.parquet")
    found = summarise_certainty(table, 0.9, IntervalParameters(), 1)
    (folder / "reports").mkdir(exist_ok=True)
    write_json(found, folder / "reports/certainty.json")
    return folder / "results/certainty.parquet", folder / "reports/certainty.json"


def evaluation_table():
    """Give four objects that a model has not learnt, named by 1 view in two ways and by 2, and one of no known class."""
    rows = [
        {
            "strategy": "fixation", "classifier": "naive_bayes", "class": category, "object": f"new{place}",
            "views": views, "bag": bag, "known": category != "ball", "correct": place < 2,
            "covered": place < 3, "candidates": 1 + views, "unknown": place == 3,
            "stated": 0.9, "learnt": 7,
        }
        for place, category in enumerate(("cup", "cup", "box", "box", "ball"))
        for views, bag in ((1, 0), (1, 1), (2, 0))
    ]  # fmt: skip
    return build_table(EVALUATION, {name: [row[name] for row in rows] for name in rows[0]})


def test_sets_of_all_classes_come_of_too_few_objects(tmp_path):
    figures = certainty_figures(*write_certainty(tmp_path))
    assert (figures["views"], figures["least"], figures["enough"]) == (4, 9, True)
    assert not certainty_figures(*write_certainty(tmp_path, candidates=2))["enough"]
