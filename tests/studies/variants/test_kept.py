"""What the pages and the report say of the variants is what the kept tables say."""

import json
import re
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from report.pages import read_page

from variants.choices import BEST_OF_PAPER
from variants.choosing import FORMER_DEFAULT
from variants.design import all_variants, is_default, is_literal
from variants.kept import OUTSIDE, PAPER_SET, kept_variants
from variants.page import COMMAND, render_variants_page, variants_figures
from variants.summary import kept_summary
from variants.tables import VARIANTS
from variants.weighing import weigh_choices
from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.tables.schema import build_rows, write_table

ROOT = Path(__file__).parents[3]
CHOSEN, CHOSEN_AGAIN = (
    json.loads(files("variants").joinpath(f"{name}.json").read_text())
    for name in ("chosen", "chosen_again")
)
ROWS = kept_variants(PAPER_SET).rows
ASKED = [row for row in ROWS if row["error"] is None and row["part"] != "protocol"]


def test_the_most_literal_variant_has_all_classifiers_of_the_paper():
    literal = kept_summary().literal
    assert {*literal["fixation"]} == {*literal["random"]} == {*TABLE_1}


def test_leads_of_the_default_and_the_literal_variant_are_bold_after_the_correction():
    """The p values of the table are corrected for all leads in its columns, by hand."""
    tables = {"12": kept_variants(PAPER_SET).rows, "130": kept_variants(OUTSIDE).rows}
    found = [
        (objects, option, row["ahead"], row["p_value"])
        for objects, rows in tables.items()
        for row in rows
        for option in [row["random_probing"]]
        if row["classifier"] == BEST_OF_PAPER and row["part"] != "protocol"
        if is_default({**row, "random_probing": "reachable"})
        or is_literal({**row, "random_probing": "walk"})
    ]
    assert len(found) == 16
    largest, stand = 0.0, set()
    for rank, lead in enumerate(sorted(found, key=lambda one: one[-1])):
        largest = max(largest, lead[-1] * (len(found) - rank))
        stand |= {lead} if largest < 0.05 else set()
    words = {
        "reachable": "in reach",
        "anywhere": "anywhere",
        "visible": "in sight",
        "walk": "a walk",
    }
    page = (ROOT / "studies/variants/README.md").read_text(encoding="utf-8")
    for lead in found:
        objects, option, ahead, p_value = lead
        written = f"{100 * ahead:+.1f}, p {p_value:.2g}".replace("-", "\N{MINUS SIGN}", 1)
        (line,) = re.findall(rf"^\| {objects} \| {words[option]} \|.*$", page, re.MULTILINE)
        assert f"| {f'**{written}**' if lead in stand else written} |" in line
    assert {lead[:2] for lead in stand} == {("130", "reachable"), ("130", "visible")}


def test_choices_that_add_up_explain_all_of_the_spread_by_themselves():
    def fixation(options):
        scaled = options["touch_scaling"] == "none"
        return 0.5 + 0.2 * (options["map_output"] == "lattice") + 0.1 * scaled

    rows = [
        {"part": one.part, **one.options, "fixation": fixation(one.options)}
        for one in all_variants()
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
    (chosen,) = [one for one in all_variants() if one.name == CHOSEN["chosen"]["variant"]]
    of_touches = {one["choice"]: one["chosen"] for one in CHOSEN["options"]}
    assert is_default({**chosen.options, **of_touches})
    options = chosen.options.items()
    changed = {name: option for name, option in options if option != FORMER_DEFAULT[name]}
    assert changed == CHOSEN["chosen"]["changed"]


def test_the_rules_applied_again_differ_from_the_default_in_the_channels_only():
    assert CHOSEN_AGAIN["chosen"]["changed"] == CHOSEN["chosen"]["changed"]
    first, again = (
        {row["choice"]: row["chosen"] for row in chosen["options"]}
        for chosen in (CHOSEN, CHOSEN_AGAIN)
    )
    differing = {name: (first[name], again[name]) for name in first if first[name] != again[name]}
    assert differing == {"channels": ("five_named", "eight_equal")}


@pytest.mark.parametrize("name", ["chosen", "best", "former"])
def test_the_kept_variants_give_the_scores_that_the_rule_saw(name):
    own = [
        row
        for row in kept_variants(OUTSIDE).rows
        if row["variant"] == CHOSEN_AGAIN[name]["variant"]
    ]
    random = [row["random"] for row in own if row["random_probing"] != "anywhere"]
    fixation = [row["fixation"] for row in own if row["random_probing"] == "reachable"]
    assert (len(fixation), len(random)) == (5, 15)
    assert np.mean(fixation + random) == pytest.approx(CHOSEN_AGAIN[name]["score"], abs=1e-3)


def test_the_kept_variants_have_a_page_that_stands_alone_and_says_where_they_come_from():
    html = render_variants_page(None)
    text = read_page(html).text
    assert f"not in this run: {kept_variants(PAPER_SET).source.date}" in text
    assert "The same on 130 objects outside the paper's set" in text
    assert "Another question: known objects" in text
    failed = {row["variant"] for row in ROWS if row["error"] is not None}
    assert f"{len(failed)} variants could not be run" in text
    shown = {(row["variant"], row["classifier"]) for row in ASKED}
    assert html.count("<circle cx") == len(shown)
    assert "://" not in html


def test_a_table_of_failures_alone_has_no_page(tmp_path):
    path = tmp_path / "variants.parquet"
    failed = [row for row in ROWS if row["error"] is not None]
    write_table(VARIANTS, build_rows(VARIANTS, failed), path)
    with pytest.raises(ReportError, match="no variant that could be run"):
        render_variants_page(path)


def test_sentences_and_dots_say_what_the_tables_hold():
    found = variants_figures(kept_variants(PAPER_SET), kept_variants(OUTSIDE))
    rows = [row for row in kept_variants(OUTSIDE).rows if row["random_probing"] == "reachable"]
    ahead = sum(row["ahead"] > 1e-12 for row in rows)
    sentence = f"ahead of random probing in {ahead} of {len(rows)} cases"
    assert sentence in found["outside"]["sentences"][0]
    dots = found["charts"][BEST_OF_PAPER]["dots"]
    (default,) = re.findall(r'class=own data-variant="(\w+)"', dots)
    assert default in {one.name for one in all_variants() if is_default(one.options)}
    assert COMMAND.format("u100") in dots
