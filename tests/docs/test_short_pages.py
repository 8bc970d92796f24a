"""The code of each short page runs, prints what the page shows, and saves the picture of the page."""

import re
import runpy
from pathlib import Path

import numpy as np
import pytest
from docs.shell_commands import blocks
from matplotlib import pyplot as plt
from PIL import Image

from visuohaptic.active.registry import STRATEGIES

ROOT = Path(__file__).parents[2]
SCRIPT = runpy.run_path(str(ROOT / "docs/make_short_pages.py"))
LONGEST = 60
"""Lines of a page: about two screens with its picture."""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """The folder in which all pages ran in their order, and what each printed."""
    folder = tmp_path_factory.mktemp("pages")
    SCRIPT["make_folder"](folder)
    with pytest.MonkeyPatch.context() as patch, plt.rc_context({"backend": "agg"}):
        # What a page registers is forgotten after it.
        for held in ("_entries", "_sources"):
            patch.setattr(STRATEGIES, held, dict(getattr(STRATEGIES, held)))
        printed = {page: SCRIPT["run_page"](page, folder) for page in SCRIPT["PAGES"]}
        plt.close("all")
    return folder, printed


@pytest.mark.parametrize("page", SCRIPT["PAGES"])
def test_a_page_prints_what_it_shows_and_saves_its_picture(ran, page):
    folder, printed = ran
    [shown] = blocks(ROOT / "docs" / f"{page}.md", "text")
    assert printed[page] == shown
    kept, saved = (
        np.asarray(Image.open(place / f"{page}.png").convert("L"), dtype=float)
        for place in (ROOT / "docs/pictures", folder)
    )
    assert kept.shape == saved.shape
    # Fonts may differ by a few grey levels at their edges.
    assert np.abs(kept - saved).mean() < 2, "python docs/make_short_pages.py keeps the picture"


@pytest.mark.parametrize("page", SCRIPT["PAGES"])
def test_a_page_is_short_and_shows_its_picture(page):
    text = (ROOT / "docs" / f"{page}.md").read_text()
    assert len(text.splitlines()) <= LONGEST
    assert f"](pictures/{page}.png)" in text


def test_a_data_set_takes_seven_lines_and_a_policy_nine_and_seven():
    [first, _] = blocks(ROOT / "docs/own_data_set.md", "python")
    [policy, compared, _] = blocks(ROOT / "docs/own_policy.md", "python")
    for code, most in ((first, 7), (policy, 9), (compared, 7)):
        lines = re.findall(r"^(?!import |from |print)\s*\S.*$", code, re.M)
        assert len(lines) <= most, lines


def test_touches_of_the_plotted_sequence_are_at_the_plotted_places(ran):
    import visuohaptic as vh

    touched = vh.example("car").touch(viewpoints=1)
    places = touched.fixations.take(touched.touches["rank"])
    for axis in "xyz":
        assert places[axis].to_pylist() == touched.touches[axis].to_pylist()
