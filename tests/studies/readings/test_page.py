"""The page of readings says what its table holds; a dot says its options and how to measure it again."""

import pytest
from report.pages import read_page

from readings import stored
from readings.choices import CHOICES
from readings.design import PARTS_ON_PAPER_SET, all_readings
from readings.page import (
    COMMAND,
    curve_chart,
    mark_up_dots,
    readings_figures,
    render_readings_page,
)
from readings.stored import (
    MeasuredReadings,
)
from readings.tables import READINGS
from visuohaptic.errors import ReportError
from visuohaptic.recognition.published import TABLE_1
from visuohaptic.report.questions import BEST_OF_PAPER
from visuohaptic.tables.schema import build_rows, write_table

READ = [reading for reading in all_readings() if reading.part in PARTS_ON_PAPER_SET]
# Known objects from new viewpoints are another question, which the figures leave out.
ASKED = [reading for reading in READ if reading.part != "protocol"]


def row_of(place, classifier, fixation, random):
    reading = READ[place]
    row = dict.fromkeys(column.name for column in READINGS.columns)
    row |= {"reading": reading.name, "classifier": classifier, "part": reading.part}
    row |= {"place": place, **reading.options, "objects": 12, "splits": 81, "seconds": 4.0}
    for strategy, accuracy in (("fixation", fixation), ("random", random)):
        row |= {strategy: accuracy, f"{strategy}_low": accuracy - 0.1}
        row |= {f"{strategy}_high": accuracy + 0.1, f"{strategy}_best_split": accuracy + 0.2}
        reached = accuracy + 0.2 >= TABLE_1[classifier][strategy]
        row |= {f"{strategy}_splits_reaching": 0.5 * reached}
    ahead = fixation - random
    row |= {"ahead": ahead, "ahead_low": ahead - 0.1, "ahead_high": ahead + 0.1}
    return row | {"p_value": 0.01 if abs(ahead) > 0.15 else 0.3}


def rows(classifiers=tuple(TABLE_1)):
    found = []
    for place in range(len(READ)):
        gain = 0.2 * (READ[place].options["map_output"] == "feature_groups")
        lead = 0.2 if gain else -0.01
        found += [
            row_of(place, classifier, 0.55 + gain, 0.55 + gain - lead) for classifier in classifiers
        ]
    return found


ROWS = rows()
FAILING = "training"
FAILED = {"error": "MiniSom has two at most <b>", "fixation": None, "ahead": None, "p_value": None}


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    path = tmp_path_factory.mktemp("readings") / "readings.parquet"
    planted = [row | FAILED if row["part"] == FAILING else row for row in ROWS]
    write_table(READINGS, build_rows(READINGS, planted), path)
    return path


def test_sentences_count_what_the_table_holds():
    found = readings_figures(MeasuredReadings(ROWS))
    texts = [text.replace("\N{NO-BREAK SPACE}", " ") for text in found.sentences]
    own = [row for row in ROWS if row["part"] != "protocol" and row["classifier"] == BEST_OF_PAPER]
    ahead = sum(row["ahead"] > 0 for row in own)
    assert texts[0] == (
        f"The paper can be read in many ways. Of {len(ASKED)} readings, its best classifier (support vector "
        "machine) has 55.0 % to 75.0 % correctly classified by fixations (median 55.0 %; our default "
        "75.0 %; published 93.45 %)."
    )
    assert f"in {100 * ahead / len(ASKED):.0f} % of the readings" in texts[1]
    assert f"fixations are ahead in {5 * ahead} of {5 * len(ASKED)} cases" in texts[1]
    assert texts[2].startswith(f"The published figure is reached by 0 of the {len(ASKED)} readings")
    assert f"and {ahead} readings have such a split" in texts[2]


def test_a_dot_says_its_figures_its_options_and_its_command():
    chart = curve_chart(ROWS, BEST_OF_PAPER)
    default = next(dot for dot in chart.dots if dot.is_default)
    assert "our default" in default.label
    other = next(dot for dot in chart.dots if dot.name == READ[300].name)
    changed = {
        choice.name for choice in CHOICES if READ[300].options[choice.name] != choice.default
    }
    assert other.label.count(";") == len(changed) - 1
    assert COMMAND.format(other.name) in other.label
    marked = mark_up_dots([type(default)(1, 2, "r1", 'a "<b>" & c', False)])
    assert "&lt;b&gt;" in marked
    assert "<b>" not in marked


def test_the_page_stands_alone_and_names_failed_readings(table):
    html = render_readings_page(table)
    page = read_page(html)
    failed = sum(reading.part == FAILING for reading in READ)
    assert f"{failed} readings could not be run" in page.text
    assert html.count("<circle cx") == 5 * (len(ASKED) - failed)
    assert "://" not in html
    assert "Another question: known objects" in page.text


def test_an_option_that_decides_who_leads_outside_is_named():
    outside = [
        dict(row, objects=130, ahead=-0.01 if row["touch_scaling"] == "none" else row["ahead"])
        for row in ROWS
        if row["part"] == "recognition"
    ]
    found = readings_figures(MeasuredReadings(ROWS), MeasuredReadings(outside)).outside
    first, second = (text.replace("\N{NO-BREAK SPACE}", " ") for text in found.sentences)
    ahead = sum(row["ahead"] > 0 for row in outside)
    assert f"ahead of random probing in {ahead} of {len(outside)} cases" in first
    assert "On 130 objects" in first
    assert "explain 100 % of how leads differ: “What the map's five numbers are” and" in second
    assert "Fixation leads with feature groups and standardise (+20.0)" in second
    assert "random probing leads with unit distances and standardise (−1.0)" in second
    turning = {one.choice for one in found.options if one.turns}
    assert "What the map's five numbers are" in turning
    assert all(one.here.cases == one.outside.cases for one in found.options)


def test_a_table_of_failures_alone_has_no_page(tmp_path):
    planted = [row | FAILED for row in rows((BEST_OF_PAPER,))]
    path = tmp_path / "readings.parquet"
    write_table(READINGS, build_rows(READINGS, planted), path)
    with pytest.raises(ReportError, match="no reading that could be run; one at least is needed"):
        render_readings_page(path)


def test_the_kept_readings_have_a_page_that_says_where_they_come_from():
    page = read_page(render_readings_page(None))
    kept = stored.kept_readings(stored.PAPER_SET)
    assert f"not in this run: {kept.source.date}" in page.text
    assert "The same on 130 objects outside the paper's set" in page.text
