"""Charts put every figure where its number says."""

from visuohaptic.report.charts import interval_chart
from visuohaptic.report.comparison import Figure


def test_marks_lie_at_their_percentages():
    rows = [
        ("one", {"fixation": Figure(0.5, 0.4, 0.7), "random": Figure(0.25, None, None)}, {}),
        ("two", {"fixation": Figure(1.0, 0.9, 1.0)}, {"fixation": 0.9345, "random": 0.8}),
    ]
    chart = interval_chart(rows, ("fixation", "random"), reference=0.25)
    here = [mark for mark in chart.marks if not mark.kind]
    published = [mark for mark in chart.marks if mark.kind == "published"]
    assert [mark.x for mark in here] == [50.0, 25.0, 100.0]
    assert (here[0].left, here[0].right) == (40.0, 70.0)
    assert here[1].left is None
    assert [mark.x for mark in published] == [93.45, 80.0]
    assert published[0].y == here[2].y
    assert chart.reference == 25.0
    assert max(mark.y for mark in chart.marks) < chart.baseline < chart.height
