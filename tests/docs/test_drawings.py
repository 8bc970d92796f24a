"""The pictures of the pages that explain are drawn by their script, and stand on a page."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt
from PIL import Image

from visuohaptic.active.registry import STRATEGIES

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def script():
    """The names of the script, with registered policies forgotten after the tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT / "docs")
        for held in ("_entries", "_sources"):
            patch.setattr(STRATEGIES, held, dict(getattr(STRATEGIES, held)))
        yield runpy.run_path(str(ROOT / "docs/make_drawings.py"))


@pytest.mark.parametrize(
    "name",
    [
        "attention",
        "section",
        "effects",
        "strategies",
        "policy",
        "environment",
        "recognition",
        "certainty",
        "intervals",
        "stability",
    ],
)
def test_a_picture_is_the_one_that_the_script_draws(script, name, tmp_path):
    with plt.rc_context({**script["STYLE"], "backend": "agg"}):
        script["save"](script["DRAWINGS"][name](), tmp_path / f"{name}.png")
    kept, drawn = (
        np.asarray(Image.open(folder / f"{name}.png").convert("L"), dtype=float)
        for folder in (ROOT / "docs/pictures", tmp_path)
    )
    assert kept.shape == drawn.shape
    # Fonts may differ by a few grey levels at their edges.
    assert np.abs(kept - drawn).mean() < 2, f"python docs/make_drawings.py {name}"


def test_every_picture_of_the_script_is_on_a_page(script):
    pages = "".join(page.read_text() for page in (ROOT / "docs").glob("*.md"))
    assert [name for name in script["DRAWINGS"] if f"](pictures/{name}.png)" not in pages] == []


def test_the_picture_of_strategies_shows_all_that_a_run_can_name(script):
    text = (ROOT / "docs/probing.md").read_text()
    rows = [line.split("`")[1] for line in text.splitlines() if line.startswith("| `")]
    shown = set(script["STRATEGIES"])
    # A policy that learns needs training objects, and values of `probing.unreachable` follow.
    assert shown | {"adaptive"} == set(rows) - {"replace", "skip", "keep"}
