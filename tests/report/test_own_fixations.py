"""Touches are compared with the fixations of the eye in four ways, and each is called by its own name."""

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from report.pages import plain

from visuohaptic.evaluation.own_fixations import count_own_fixations
from visuohaptic.report.own_fixations import own_fixations_rows, own_fixations_sentence

KEPT = Path(__file__).parents[1] / "golden/kept/default_run"


def ranked(ranks, strategy="fixation"):
    """Return touches of one object from the ranks of each view's touches."""
    rows = [
        (view, touch, rank)
        for view, touched in enumerate(ranks)
        for touch, rank in enumerate(touched)
    ]
    views, touches, places = np.reshape(rows, (-1, 3)).T
    columns = {"class": "cup", "object": "mug", "strategy": strategy}
    columns = {name: [value] * len(rows) for name, value in columns.items()}
    return pa.table({**columns, "viewpoint": views, "touch": touches, "rank": places})


def views(count):
    owner = {"class": ["cup"] * count, "object": ["mug"] * count}
    return pa.table({**owner, "viewpoint": np.arange(count)})


def count(ranks, fixations=3, more=0):
    touches = pa.concat_tables([ranked(ranks), ranked([[7, 8]], "random")])
    return count_own_fixations(touches, views(len(ranks) + more), fixations)


def test_the_four_ways_of_counting_differ():
    # As fixated; moved up by one; first passed over within the eye's three and touched no other; a shorter view.
    found = count([[0, 1, 2], [0, 2, 3], [1, 2], [0, 1]], more=1)
    assert (found.touches, found.views) == (10, 5)
    assert found.views_as_fixated == 1 / 5
    assert found.views_replaced == 1 / 5
    assert found.touches_out_of_turn == 4 / 10
    assert found.touches_elsewhere == 1 / 10
    assert found.views_without_first == 2


def test_the_same_fixations_in_another_order_or_twice_are_not_those_of_the_eye():
    assert count([[0, 1, 1]]).views_as_fixated == 0
    assert count([[1, 0, 2]]).views_as_fixated == 0
    assert count([[0, 1, 2, 3]]).views_as_fixated == 0


def test_each_sentence_has_its_own_figure():
    said = plain(own_fixations_sentence(count([[0, 1, 2], [0, 2, 3], [1, 2, 4], [0, 1, 2]])))
    assert said == (
        "50 % of the 4 views are touched at exactly their first 3 fixations. In the others the sensor can't reach at least "
        "one of these places. Later places of the view then move up: 42 % of the touches are not at the fixation of the "
        "same number, and 17 % are at none of the view's first 3 fixations. Of all views 50 % have such a touch. In 1 view "
        "the most salient place is never touched."
    )
    skipped = plain(own_fixations_sentence(count([[0, 1, 2], [1, 2]])))
    assert "move up" not in skipped
    assert skipped.endswith("In 1 view the most salient place is never touched.")


def test_nothing_is_said_where_the_eyes_fixations_are_touched_or_none_is():
    assert own_fixations_sentence(count([[0, 1, 2], [0, 1, 2]])) == ""
    random = count_own_fixations(ranked([[7, 8]], "random"), views(1), 3)
    assert random is None
    assert own_fixations_sentence(random) == ""
    assert own_fixations_rows(random) == []


def test_rows_name_denominators():
    rows = own_fixations_rows(count([[0, 1, 2], [0, 2, 3]]))
    assert [(row["of"], row["share"]) for row in rows] == [
        (2, 0.5),
        (2, 0.5),
        (6, pytest.approx(2 / 6)),
        (6, pytest.approx(1 / 6)),
    ]


def test_the_kept_default_run_is_counted_as_pandas_counts():
    touches, fixations = (
        pd.read_parquet(KEPT / f"{name}.parquet") for name in ("touches", "fixations")
    )
    found = count_own_fixations(pa.Table.from_pandas(touches), pa.Table.from_pandas(fixations), 5)
    own = touches[touches["strategy"] == "fixation"]
    by_view = own.sort_values("touch").groupby(["class", "object", "viewpoint"])["rank"].agg(list)
    assert (found.touches, found.views) == (960, 192) == (len(own), len(by_view))
    assert found.views_as_fixated == (by_view.map(str) == "[0, 1, 2, 3, 4]").mean() == 84 / 192
    assert found.views_replaced == (by_view.map(max) > 4).mean()
    assert found.touches_out_of_turn == (own["rank"] != own["touch"]).mean()
    assert found.touches_elsewhere == (own["rank"] > 4).mean()
    assert found.views_without_first == (by_view.map(min) > 0).sum() == 43
