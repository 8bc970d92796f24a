"""Charts are the same bytes each time, fit into a page, and stand out from it."""

import re
from xml.etree import ElementTree as ET

import matplotlib as mpl
import pytest

from visuohaptic.pictures.page_head import page_style
from visuohaptic.report import figures
from visuohaptic.report.drawing import COLOURS, inline_svg, write_svg

LIGHT, DARK = (
    dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block))
    for block in re.findall(r":root[^{]*\{(.*?)\}", page_style(), re.DOTALL)[:2]
)


def chart():
    names = ("strategy", "accuracy", "low", "high")
    found = ("fixation", 0.5, 0.4, 0.6), ("random", 1.0, 0.7, 1.0)
    return figures.conditions(
        [{"condition": "a", **dict(zip(names, row, strict=True))} for row in found]
    )


@pytest.fixture(scope="module")
def svg():
    return inline_svg(chart(), "one", 'What "it" <shows>')


def test_the_same_table_gives_the_same_bytes_whatever_a_reader_has_set():
    before = dict(mpl.rcParams)
    first = chart()._repr_svg_()
    assert dict(mpl.rcParams) == before
    with mpl.rc_context({"font.size": 30, "lines.linewidth": 9, "svg.fonttype": "path"}):
        assert write_svg(chart()) == first
    assert not re.search(r"20\d\d-\d\d", first)


def test_a_chart_is_described_and_as_wide_as_its_place_and_its_text_is_text(svg):
    root = ET.fromstring(svg)  # noqa: S314 - made here
    assert (root.get("role"), root.get("aria-label")) == ("img", 'What "it" <shows>')
    assert root.get("viewBox").startswith("0 0 360 ")
    assert root.get("width") is None
    assert "correctly classified" in ["".join(one.itertext()) for one in root.iter("text")]
    assert "<style" not in svg


def test_colours_are_those_of_the_page_light_or_dark(svg):
    assert {name: LIGHT[name] for name in COLOURS} == COLOURS
    assert "var(--fixation)" in svg
    assert not re.search(r"#[0-9a-f]{6}\b", svg)


def test_two_charts_of_a_page_share_no_id_and_each_finds_its_own():
    both = inline_svg(chart(), "one", "") + inline_svg(chart(), "two", "")
    identifiers = re.findall(r'\bid="([^"]*)"', both)
    assert identifiers
    assert len(identifiers) == len(set(identifiers))
    used = set(re.findall(r'href="#([^"]*)"|url\(#([^)]*)\)', both))
    assert {first or second for first, second in used} == set(identifiers)


def luminance(colour):
    shares = [int(colour[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    linear = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares]
    return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def test_marks_stand_out_from_the_page():
    """By WCAG 2.2, 1.4.11; axe looks at text alone."""
    for colours in (LIGHT, DARK):
        for series in list(COLOURS)[5:]:
            darker, lighter = sorted(luminance(colours[name]) for name in (series, "paper"))
            assert (lighter + 0.05) / (darker + 0.05) >= 3, series
