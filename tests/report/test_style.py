"""Marks of charts stand out from the page, in light and in dark (WCAG 2.2, 1.4.11); axe looks at text."""

import re
from importlib.resources import files

import pytest

from visuohaptic.report.drawing import COLOURS

STYLE = files("visuohaptic.report").joinpath("templates", "style.css").read_text("utf-8")
LIGHT, DARK = (
    dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block))
    for block in re.findall(r":root[^{]*\{(.*?)\}", STYLE, re.DOTALL)[:2]
)


def luminance(colour):
    shares = [int(colour[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    linear = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares]
    return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def contrast(one, other):
    darker, lighter = sorted((luminance(one), luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_marks_stand_out_from_the_page(colours):
    for series in list(COLOURS)[5:]:
        assert contrast(colours[series], colours["paper"]) >= 3, series
