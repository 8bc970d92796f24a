"""Colours of the page stand out from each other, in light and in dark (WCAG 2.2, 1.4.3 and 1.4.11)."""

import re
from importlib.resources import files

import pytest

from visuohaptic.report.drawing import COLOURS

STYLE = files("visuohaptic.report").joinpath("templates", "style.css").read_text("utf-8")
LIGHT, DARK = (
    dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block))
    for block in re.findall(r":root[^{]*\{(.*?)\}", STYLE, re.DOTALL)[:2]
)
TEXTS = ("ink", "quiet", "link")


def luminance(colour):
    shares = [int(colour[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    linear = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares]
    return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def contrast(one, other):
    darker, lighter = sorted((luminance(one), luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


def mixed(colour, back, share):
    parts = [[int(c[place : place + 2], 16) for c in (colour, back)] for place in (1, 3, 5)]
    return "#" + "".join(f"{round(share * a + (1 - share) * b):02x}" for a, b in parts)


def test_contrast_is_that_of_the_standard():
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_text_can_be_read_on_every_ground(colours):
    for ground in ("paper", "panel"):
        for text in TEXTS:
            assert contrast(colours[text], colours[ground]) >= 4.5, (text, ground)
    assert contrast(colours["ink"], colours["caution-back"]) >= 4.5
    assert contrast(colours["ink"], colours["bad-back"]) >= 4.5
    assert contrast(colours["bad"], colours["paper"]) >= 4.5
    # The deepest shade of a share: 40 % over a panel, 45 % over paper in a confusion table.
    for ground, share in (("panel", 0.40), ("paper", 0.45)):
        assert contrast(colours["ink"], mixed(colours["shade"], colours[ground], share)) >= 4.5


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_marks_stand_out_from_the_page(colours):
    for series in list(COLOURS)[5:]:
        assert contrast(colours[series], colours["paper"]) >= 3, series
