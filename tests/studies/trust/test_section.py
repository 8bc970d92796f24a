"""The section of study `trust` shows what was measured."""

import numpy as np
from report.test_figures import marks

from trust.classes_left_out import summarise_trust
from trust.section import coverage, trust_figures
from trust.tables import STATED_COVERAGES, TRUST
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import write_json
from visuohaptic.tables.schema import build_table, write_table


def trust_table(fits=(0.05, 0.15, 0.45, 0.95), strange=(0.25, 0.65, 0.95, 1.0), candidates=1):
    """Return two strategies that name each of `fits` known and of `strange` unknown objects by 4 views."""
    rows = [
        {
            "strategy": strategy, "classifier": "naive_bayes", "left_out": left_out,
            "class": left_out if not known else "cup", "object": f"{known}{place}", "views": 4,
            "known": known, "correct": known, "covered": known and value > 0.1,
            "covered_at": [stated for stated in STATED_COVERAGES if known and value > 1 - stated / 100 + 1e-12],
            "candidates": candidates,
            "novelty_rank": 0.35 if known else value, "evidence": 0.35 if known else value,
            "unknown": not known and value > 0.9,
        }
        for strategy in ("fixation", "random")
        for left_out in ("ball", "box", "can")
        for known, values in ((True, fits), (False, strange))
        for place, value in enumerate(values)
    ]  # fmt: skip
    return build_table(TRUST, {name: [row[name] for row in rows] for name in rows[0]})


def write_trust(folder, **columns):
    """Write the table and its figures where the workflow does."""
    table = trust_table(**columns)
    write_table(TRUST, table, folder / "results/trust.parquet")
    found = summarise_trust(table, 0.9, IntervalParameters())
    (folder / "reports").mkdir(exist_ok=True)
    write_json(found, folder / "reports/trust.json")
    return folder / "results/trust.parquet", folder / "reports/trust.json"


def test_sets_of_all_classes_come_of_too_few_objects(tmp_path):
    figures = trust_figures(*write_trust(tmp_path))
    assert (figures["views"], figures["least"], figures["enough"]) == (4, 9, True)
    assert not trust_figures(*write_trust(tmp_path, candidates=2))["enough"]


def test_coverage_counts_the_sets_that_would_hold_the_class():
    # At 50 % sets hold what fits better than 50 %, at 60 % what fits better than 40 %, ...
    expected = [0.25, 0.25, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.75, 0.75]
    drawn = marks(coverage(trust_table()), "eye fixations")
    np.testing.assert_allclose(drawn[:, 1], expected)
