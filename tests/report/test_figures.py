"""Every chart holds the numbers of its table, has named axes, and a mark and a colour for each series."""

import json

import numpy as np
import pytest
from report.synthetic import write_run, write_study
from report.test_stability import EXACT, GRAZING
from studies.cost.test_front import cost_rows, cost_table

from visuohaptic.active.registry import STRATEGIES
from visuohaptic.base.errors import ReportError
from visuohaptic.report import figures
from visuohaptic.report.comparison import pipeline_tables
from visuohaptic.report.drawing import look
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.leads import Lead
from visuohaptic.report.studies import read_figures
from visuohaptic.report.wording import strategy_place
from visuohaptic.stability.rows import result_table

POINTS = [("1 touch", 0.01, 0.4), ("2 touches", 0.02, 0.5), ("5 touches", 0.1, 0.02)]


def marks(figure, label):
    """Return the places of the marks of one series, x and y."""
    (axes,) = figure.axes
    (line,) = (line for line in axes.get_lines() if line.get_label() == label)
    return line.get_xydata()


def intervals(figure, axis):
    """Return the ends of all intervals, along the axis x (0) or y (1)."""
    (axes,) = figure.axes
    paths = [path for lines in axes.collections for path in lines.get_paths()]
    return {tuple(path.vertices[:, axis]) for path in paths}


@pytest.fixture(scope="module")
def metrics(tmp_path_factory):
    files = write_run(tmp_path_factory.mktemp("run"))
    return json.loads(files.metrics.read_text())


@pytest.fixture
def measured(tmp_path):
    rows = [("1 touch", 0.6, None, None), ("2 touches", 0.8, None, None)]
    return read_figures(write_study(tmp_path, "mine", rows), "mine")


def test_every_axis_has_a_name(metrics, measured):
    for figure in (
        figures.comparison(pipeline_tables(metrics)[0]),
        figures.conditions(measured),
        figures.cost(cost_table(POINTS)),
        figures.stability(result_table([GRAZING, EXACT], "cup/mug")),
        figures.bands([0.1, 0.4]),
    ):
        (axes,) = figure.axes
        assert axes.get_xlabel()
        assert axes.get_ylabel()


def test_marks_of_the_comparison_lie_at_the_accuracies(metrics):
    figure = figures.comparison(pipeline_tables(metrics)[0])
    for strategy, label in (("fixation", "eye fixations"), ("random", "random probing")):
        cells = metrics["results"]["paper"][strategy].values()
        means = sorted(cell["accuracy"]["mean"] for cell in cells)
        assert sorted(marks(figure, label)[:, 0]) == pytest.approx(means)
        ends = {(cell["accuracy"]["low"], cell["accuracy"]["high"]) for cell in cells}
        assert ends <= intervals(figure, 0)
    assert 0.9345 in marks(figure, "eye fixations, published")[:, 0]
    assert marks(figure, "chance")[0][0] == 0.5


def test_a_condition_that_failed_has_no_row_and_nothing_measured_is_refused(tmp_path):
    rows = [("as run", 0.8, None, None), ("no edge", None, None, None)]
    found = read_figures(write_study(tmp_path, "mine", rows), "mine")
    assert len(figures.conditions(found).axes[0].get_yticklabels()) == 1
    with pytest.raises(ReportError, match="nothing to draw"):
        figures.conditions(found[1:])
    with pytest.raises(ReportError, match="nothing to draw"):
        figures.cost(cost_table(POINTS, ["8 × 8"]).to_pylist()[3:])


@pytest.mark.parametrize("errors", [(0.2, 0.06, 0.0008), (0.3, 0.2), (0.15, 0.0)])
def test_every_error_rate_lies_within_the_axes(errors):
    points = [(f"{n} touches", n / 100, error) for n, error in enumerate(errors, 1)]
    (axes,) = figures.cost(cost_table(points)).axes
    low, high = axes.get_ylim()
    drawn = np.concatenate([line.get_ydata() for line in axes.get_lines() if len(line.get_ydata())])
    assert low < drawn.min()
    assert drawn.max() < high


def test_a_line_joins_settings_of_which_one_thing_changes_and_no_others():
    rows = cost_rows([("skin", 0.1, 0.2), ("pose", 0.2, 0.1), ("5 touches", 0.3, 0.05)])
    for row, touches in zip(rows, (3, 3, 5), strict=True):
        row |= {"touches": touches, "viewpoints": 1}
    lines = [[row["setting"] for row in line] for line in figures.trends(rows)]
    assert lines == [["skin"], ["pose", "5 touches"]]


def test_each_strategy_has_a_mark_and_a_colour_of_its_own():
    looks = [look(strategy_place(name)) for name in (*STRATEGIES.names, "adaptive")]
    colours, shapes = zip(*looks, strict=True)
    assert len(set(colours)) == len(set(shapes)) == len(looks)


def test_learning_policies_of_plug_ins_look_different():
    names = (*STRATEGIES.names, "adaptive", "in_order", "far")
    assert len({look(strategy_place(name)) for name in names}) == len(names)


def lead_of(name, mean, turns="none"):
    figure = Estimate(mean, mean - 0.02, mean + 0.02, 0.5, mean - 0.05, mean + 0.05, 0.9)
    return Lead(name, "paper", turns, "full", 5, 142, figure)


def test_leads_have_a_row_per_condition_and_both_intervals_of_each_lead():
    shown = [lead_of("seeing", 0.1), lead_of("salience", -0.01), lead_of("salience", 0.03, "any")]
    (axes,) = figures.leads(shown).axes
    labels = [label.get_text().replace("\n", " ") for label in axes.get_yticklabels()]
    assert labels == [
        "The paper's pipeline, upright, facing one way",
        "The paper's pipeline, turned in any way",
    ]
    places = [[*line.get_xdata()] for line in axes.lines if line.get_marker() != "None"]
    assert places == [[0.1], [-0.01, 0.03]]
    drawn = sorted(
        (round(float(segment[0][0]), 3), round(float(segment[1][0]), 3), lines.get_linewidth()[0])
        for lines in axes.collections
        for segment in lines.get_segments()
    )
    thin = [(-0.06, 0.04), (-0.02, 0.08), (0.05, 0.15)]
    thick = [(-0.03, 0.01), (0.01, 0.05), (0.08, 0.12)]
    assert [one[:2] for one in drawn if one[2] < 1] == thin
    assert [one[:2] for one in drawn if one[2] > 1] == thick


def test_no_lead_is_nothing_to_draw():
    with pytest.raises(ReportError, match="No lead was measured"):
        figures.leads([])


def test_accuracies_by_touches_have_a_line_per_series_and_a_band_where_there_are_intervals():
    sure = [Estimate(0.2, 0.1, 0.3), Estimate(0.6, 0.5, 0.7)]
    series = [
        figures.Series("sure", 0, sure),
        figures.Series("bare", 1, [None, Estimate(0.4)]),
    ]
    drawn = figures.draw_by_touches((1, 5), series)
    assert marks(drawn, "sure").tolist() == [[1, 0.2], [5, 0.6]]
    assert marks(drawn, "bare").tolist() == [[5, 0.4]]
    (axes,) = drawn.axes
    (band,) = axes.collections
    corners = {tuple(corner) for path in band.get_paths() for corner in path.vertices}
    assert corners >= {(1, 0.1), (1, 0.3), (5, 0.5), (5, 0.7)}
    assert [label.get_text() for label in axes.get_xticklabels()] == ["1", "5"]


@pytest.mark.parametrize(
    ("difference", "words"),
    [
        (0.025, "+2.5"),
        (-0.1, "\N{MINUS SIGN}10"),
        (0.1, "+10"),
        (0.004, "+0.4"),
        (-0.0, "0"),
        (1, "+100"),
    ],
)
def test_a_tick_between_whole_points_keeps_its_decimal(difference, words):
    assert figures.as_points(difference) == words
