"""Accuracies of turned objects that are kept, in rows."""

import pytest
from studies.kept_tables import write_kept

from turned.kept import HEADLINE_TOUCHES, read_turned, turned_set
from turned.rows import CellName, contrast, curve_rows, frame_rows, turned_rows
from turned.study import STRATEGIES
from turned.tables import TURNED
from visuohaptic.base.errors import ReportError
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.keeping import Source, kept_file
from visuohaptic.tables.schema import build_rows

OBJECTS = (("box", "a"), ("box", "b"), ("cup", "c"))
SOURCE = Source("paper", "0123456789abcdef", "2026-11-26")


def cell(turns, strategy, accuracy, pipeline="paper", known="full", touches=HEADLINE_TOUCHES):
    """Return rows of a cell; object number n has weight 1 + n, and the cup took part in choosing."""
    named = {
        "turns": turns, "strategy": strategy, "pipeline": pipeline, "known": known, "touches": touches,
        "classifier": "support_vector_machine", "draws": 5,
    }  # fmt: skip
    return [
        {
            **named, "class": category, "object": name, "accuracy": one, "weight": 1.0 + place,
            "held_out": category != "cup",
        }
        for place, ((category, name), one) in enumerate(zip(OBJECTS, accuracy, strict=True))
        if one is not None
    ]  # fmt: skip


ROWS = [
    *cell("any", "random", [0.5, None, 0.25]),
    *cell("any", "fixation", [0.25, 0.75, 0.5]),
    *cell("any", "random_visible", [0.5, 0.5, 0.5]),
    *cell("none", "random", [0.5, 0.5, 0.5], "order_free"),
    *cell("none", "random_visible", [0.75, 0.5, 0.5], "order_free"),
    *cell("none", "fixation", [1.0, 1.0, 1.0], "order_free"),
    *cell("vertical", "fixation", [1.0, 1.0, 1.0], "order_free"),
    *cell("any", "random", [0.25, 0.25, 1.0], "order_free", "none"),
    *cell("any", "random_visible", [0.5, 0.5, 1.0], "order_free", "none"),
    *cell("any", "fixation", [0.5, 1.0, 0.0], "order_free", "none"),
    *cell("any", "fixation", [0.0, 0.0, 0.0], "order_free", "none", 20),
]


def kept_of(rows=ROWS):
    return turned_set(build_rows(TURNED, rows), SOURCE)


def test_rows_are_weighted_means_over_the_objects_of_all_strategies(tmp_path):
    write_kept(build_rows(TURNED, ROWS), tmp_path, "paper")
    first, second = turned_rows(read_turned(tmp_path)["paper"], IntervalParameters())
    assert (first.turns, first.pipeline, second.turns, second.pipeline) == (
        "none", "order_free", "any", "paper",
    )  # fmt: skip
    assert second.fixation.mean == pytest.approx((0.25 + 1.5) / 4)
    assert (second.objects, second.draws) == (2, 5)


def test_frames_are_compared_on_the_objects_that_took_no_part_in_choosing():
    kept = kept_of()
    assert kept.held_out.tolist() == [True, True, False]
    upright, unknown = frame_rows(kept, IntervalParameters())
    assert (upright.known, unknown.known, unknown.objects) == ("full", "none", 2)
    assert unknown.fixation.mean == pytest.approx((0.5 + 2 * 1.0) / 3)


def test_a_curve_has_the_objects_that_have_sequences_of_all_lengths():
    rows = [
        {**row, "held_out": True}
        for strategy in STRATEGIES
        for touches, values in ((5, [0.5, 1.0, 0.5]), (20, [1.0, None, 1.0]))
        for row in cell("any", strategy, values, "order_free", "none", touches)
    ]
    kept = kept_of(rows)
    short, long = curve_rows(kept, IntervalParameters())
    assert (short.touches, long.touches) == (5, 20)
    assert (short.objects, long.objects) == (2, 2)
    assert (short.fixation.mean, long.fixation.mean) == (0.5, 1.0)
    only_short = kept_of([row for row in rows if row["touches"] == 5])
    assert curve_rows(only_short, IntervalParameters()) == []


def test_a_change_of_a_lead_is_a_contrast_of_four_cells_over_the_same_objects():
    kept = kept_of()
    unknown, known = ("any", "none", 5), ("none", "full", 5)
    plus = [CellName(*unknown, "fixation"), CellName(*known, "random")]
    minus = [CellName(*unknown, "random"), CellName(*known, "fixation")]
    found = contrast(kept, plus, minus, IntervalParameters())
    assert found.mean == pytest.approx((-0.25 + 2 * 0.25) / 3)
    assert -2 <= found.low < found.mean < found.high <= 2
    with pytest.raises(ReportError, match="is kept for any centre 5 random"):
        contrast(kept, [CellName("any", "centre", 5, "random")], [], IntervalParameters())


def test_a_damaged_file_is_named(tmp_path):
    kept_file(tmp_path, "paper").write_text("no table")
    with pytest.raises(
        ReportError, match=r"kept_paper\.parquet holds no result of study turned .*make turned"
    ):
        read_turned(tmp_path)
    assert all(turned_rows(one, IntervalParameters()) for one in read_turned().values())
