"""What the pages and the report say of the readings is what the kept tables say."""

import json
import re
import runpy
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from report.pages import read_page

from readings.choosing import FORMER_DEFAULT
from readings.design import all_readings, is_default
from readings.figures import weigh_choices
from readings.page import COMMAND, readings_figures, render_readings_page
from readings.stored import OUTSIDE, PAPER_SET, kept_readings
from readings.summary import summarise
from readings.tables import READINGS
from visuohaptic.errors import ReportError
from visuohaptic.recognition.published import TABLE_1
from visuohaptic.report.questions import BEST_OF_PAPER
from visuohaptic.tables.schema import build_rows, write_table

DOCS = Path(__file__).parents[3] / "docs"
CHOSEN = json.loads(files("readings").joinpath("chosen.json").read_text())
ROWS = kept_readings(PAPER_SET).rows
ASKED = [row for row in ROWS if row["error"] is None and row["part"] != "protocol"]


def test_the_tables_of_the_pages_are_those_of_the_kept_readings(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    for page, blocks in runpy.run_path(str(DOCS / "make_readings.py"))["blocks"]().items():
        text = (DOCS / page).read_text(encoding="utf-8")
        for name, table in blocks.items():
            assert f"<!-- {name} -->\n{table}\n<!-- /{name} -->" in text


def test_what_the_report_says_follows_from_the_kept_tables():
    kept = json.loads(files("visuohaptic.report").joinpath("readings.json").read_text("utf-8"))
    found = summarise(kept_readings(PAPER_SET), kept_readings(OUTSIDE))
    assert found.model_dump(mode="json") == kept
    assert {*found.literal["fixation"]} == {*found.literal["random"]} == {*TABLE_1}


def test_choices_that_add_up_explain_all_of_the_spread_by_themselves():
    def fixation(options):
        scaled = options["touch_scaling"] == "none"
        return 0.5 + 0.2 * (options["map_output"] == "lattice") + 0.1 * scaled

    rows = [
        {"part": one.part, **one.options, "fixation": fixation(one.options)}
        for one in all_readings()
        if one.part == "recognition"
    ]
    found = {tuple(row["choices"]): row for row in weigh_choices(rows)}
    of_map, of_scaling = (found.pop((name,)) for name in ("map_output", "touch_scaling"))
    assert of_map["share"] + of_scaling["share"] == pytest.approx(1)
    assert of_map["gains"]["lattice"] == pytest.approx(0.2)
    assert max(row["share"] for row in found.values()) < 1e-9


def test_of_pairs_in_the_fraction_those_with_the_map_output_alone_are_shown():
    rows = [row for row in ASKED if row["random_probing"] == "reachable"]
    found = weigh_choices([row for row in rows if row["classifier"] == BEST_OF_PAPER])
    pairs = [one["choices"] for one in found if one["part"] == "upstream" and not one["gains"]]
    assert pairs
    assert all("map_output" in pair for pair in pairs)


def test_the_package_has_the_default_that_the_rules_chose():
    (chosen,) = [one for one in all_readings() if one.name == CHOSEN["chosen"]["reading"]]
    of_touches = {one["choice"]: one["chosen"] for one in CHOSEN["options"]}
    assert is_default({**chosen.options, **of_touches})
    options = chosen.options.items()
    changed = {name: option for name, option in options if option != FORMER_DEFAULT[name]}
    assert changed == CHOSEN["chosen"]["changed"]


@pytest.mark.parametrize("name", ["chosen", "best", "former"])
def test_the_kept_readings_give_the_scores_that_the_rule_saw(name):
    own = [row for row in kept_readings(OUTSIDE).rows if row["reading"] == CHOSEN[name]["reading"]]
    random = [row["random"] for row in own if row["random_probing"] != "anywhere"]
    fixation = [row["fixation"] for row in own if row["random_probing"] == "reachable"]
    assert (len(fixation), len(random)) == (5, 15)
    assert np.mean(fixation + random) == pytest.approx(CHOSEN[name]["score"], abs=1e-3)


def test_the_kept_readings_have_a_page_that_stands_alone_and_says_where_they_come_from():
    html = render_readings_page(None)
    text = read_page(html).text
    assert f"not in this run: {kept_readings(PAPER_SET).source.date}" in text
    assert "The same on 130 objects outside the paper's set" in text
    assert "Another question: known objects" in text
    failed = {row["reading"] for row in ROWS if row["error"] is not None}
    assert f"{len(failed)} readings could not be run" in text
    shown = {(row["reading"], row["classifier"]) for row in ASKED}
    assert html.count("<circle cx") == len(shown)
    assert "://" not in html


def test_a_table_of_failures_alone_has_no_page(tmp_path):
    path = tmp_path / "readings.parquet"
    failed = [row for row in ROWS if row["error"] is not None]
    write_table(READINGS, build_rows(READINGS, failed), path)
    with pytest.raises(ReportError, match="no reading that could be run"):
        render_readings_page(path)


def test_sentences_and_dots_say_what_the_tables_hold():
    found = readings_figures(kept_readings(PAPER_SET), kept_readings(OUTSIDE))
    rows = [row for row in kept_readings(OUTSIDE).rows if row["random_probing"] == "reachable"]
    ahead = sum(row["ahead"] > 1e-12 for row in rows)
    sentence = f"ahead of random probing in {ahead} of {len(rows)} cases"
    assert sentence in found["outside"]["sentences"][0]
    dots = found["charts"][BEST_OF_PAPER]["dots"]
    (default,) = re.findall(r'class=own data-reading="(\w+)"', dots)
    assert default in {one.name for one in all_readings() if is_default(one.options)}
    assert COMMAND.format("u100") in dots
