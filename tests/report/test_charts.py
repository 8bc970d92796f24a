"""Charts put every figure where its number says."""

from visuohaptic.report.charts import interval_chart, place_share, share_chart
from visuohaptic.report.comparison import Figure


def test_marks_lie_at_their_percentages():
    rows = [
        ("one", {"fixation": Figure(0.5, 0.4, 0.7), "random": Figure(0.25, None, None)}, {}),
        ("two", {"fixation": Figure(1.0, 0.9, 1.0)}, {"fixation": 0.9345, "random": 0.8}),
    ]
    chart = interval_chart(rows, ("fixation", "random"), reference=0.25)
    here = [mark for mark in chart.marks if mark.kind != "published"]
    published = [mark for mark in chart.marks if mark.kind == "published"]
    assert [mark.x for mark in here] == [50.0, 25.0, 100.0]
    assert (here[0].left, here[0].right) == (40.0, 70.0)
    assert here[1].left is None
    assert [mark.x for mark in published] == [93.45, 80.0]
    assert published[0].y == here[2].y
    assert chart.reference == 25.0
    assert max(mark.y for mark in chart.marks) < chart.baseline < chart.height


def test_shares_of_a_limit_stand_in_their_order_and_never_beyond_the_chart():
    shares = [0.0, 1e-300, 1e-7, 1e-3, 0.5, 1.0, 1.001, 10.0, 1e9, float("inf")]
    places = [place_share(share) for share in shares]
    assert places == sorted(places)
    assert (places[0], places[-1]) == (0, 100)
    assert places[3] < places[4] < places[5] < places[6] < 100


def test_a_row_of_shares_ends_at_its_largest_and_says_what_is_beyond_the_limit():
    chart = share_chart(
        [("rays", "3 cases", [(0.0, "a"), (0.5, "b")]), ("images", "", [(2.0, "c")])]
    )
    first, second = chart.rows
    assert first.end == place_share(0.5) < place_share(1.0) < second.end
    assert (first.exceeded, second.exceeded) == (False, True)
    assert first.y < second.y < chart.bottom < chart.height
