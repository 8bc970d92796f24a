"""No public name, command, column or parameter of the last release goes without a line in the changelog."""

import json
import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
KEEPER = runpy.run_path(str(ROOT / "release/interface.py"))
CHANGELOG = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def interface():
    return KEEPER["current_interface"]()


@pytest.fixture(scope="module")
def kept():
    return json.loads(KEEPER["RECORD"].read_text(encoding="utf-8"))


def gone(kept, interface, newest):
    """List the kept entries that the code lacks and the newest part of the changelog does not name."""
    lacking = {name for kind in interface for name in set(kept[kind]) - set(interface[kind])}
    return sorted(name for name in lacking if f"`{name}`" not in newest)


def test_what_goes_is_named_in_the_changelog(kept, interface):
    newest = re.split(r"^## ", CHANGELOG, flags=re.M)[1]
    assert gone(kept, interface, newest) == [], "see docs/stable_interface.md"


def test_the_record_is_of_the_release():
    facts = (ROOT / "release/facts.yaml").read_text()
    version = re.search(r"^version: (\S+)$", facts, re.M)[1]
    assert json.loads(KEEPER["record_of"](version))["version"] == version
    assert KEEPER["record_of"](version) == KEEPER["RECORD"].read_text(), "run `make release`"


def test_a_name_that_goes_would_be_noticed(kept, interface):
    more = {kind: [*names, f"old {kind}"] for kind, names in interface.items()}
    assert gone(more, interface, "") == sorted(f"old {kind}" for kind in interface)
    assert gone(more, interface, " ".join(f"`old {kind}`" for kind in interface)) == []


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("names", "visuohaptic.press(poses)"),
        ("names", "visuohaptic.Exploration.touch_next"),
        ("names", "contourlets.Contourlet.forward"),
        ("commands", "visuohaptic touch --viewpoints"),
        ("columns", "touches.sensor_size: double"),
        ("parameters", "recognition.order_free.coverage"),
    ],
)
def test_names_of_every_kind_are_kept(kept, kind, name):
    assert name in kept[kind]
