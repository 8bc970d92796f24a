"""Numbers and names in words, the same everywhere on the page."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence

from visuohaptic.active.registry import STRATEGIES
from visuohaptic.evaluation.published import PAPER_PIPELINE
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.classifiers import CLASSIFIERS

ADAPTIVE = "adaptive touching"
CONTACT_STATES = {
    "full": "the largest sensor fits, and the object lies under all of the sensor",
    "shrunk": "the sensor shrank until nothing penetrates it",
    "partial": "the object lies under only a part of the sensor",
    "at_minimum": "the object penetrates even the smallest sensor",
    "blocked": "another part of the object is in the way of the approaching sensor",
}

POSES: Mapping[Turns, str] = {
    "none": "upright, facing one way",
    "vertical": "upright, turned about the vertical",
    "any": "turned in any way",
}
"""The poses of the objects in words, by `meshes.turns`."""

_NO_BREAK = "\N{NO-BREAK SPACE}"
_MINUS = "\N{MINUS SIGN}"


def classifier_name(key: str) -> str:
    """Return a classifier's name in words; an unknown key has its underscores replaced by spaces."""
    return CLASSIFIERS[key].label if key in CLASSIFIERS.names else spaced(key)


def strategy_name(key: str) -> str:
    """Return a probing strategy's name in words; an unknown key has its underscores replaced by spaces."""
    if key == "adaptive":
        return ADAPTIVE
    return STRATEGIES[key].label if key in STRATEGIES.names else spaced(key)


def pipeline_name(key: str) -> str:
    """Return a pipeline's name for use within a sentence."""
    return "the paper's pipeline" if key == PAPER_PIPELINE else f"pipeline {key}"


def strategy_place(key: str) -> int:
    """Return a number that fixes a strategy's colour and mark in every chart.

    The number is the index among all strategies. Learning policies of plug-ins follow, by a digest of their names.
    """
    names = (*STRATEGIES.names, "adaptive")
    if key in names:
        return names.index(key)
    return len(names) + int(hashlib.sha256(key.encode()).hexdigest(), 16) % 97


def titled(name: str) -> str:
    """Return a name with an upper-case first letter; the k of k nearest neighbours stays lower-case."""
    return name if name.startswith("k ") else name[:1].upper() + name[1:]


def spaced(key: str) -> str:
    """Return a name with spaces instead of underscores."""
    return key.replace("_", " ")


def percent(share: float, decimals: int = 1) -> str:
    """Return a share in [0, 1] as a percentage, such as ``70.0 %``."""
    return f"{_with_minus(f'{100 * share:.{decimals}f}')}{_NO_BREAK}%"


def points(difference: float) -> str:
    """Return a difference of shares in percentage points, with its sign, such as ``+2.5``."""
    return _with_minus(f"{100 * difference:+.1f}")


def percent_points(size: float) -> str:
    """Return the size of a difference of shares in percentage points, such as ``2.5``."""
    return f"{100 * size:.1f}"


def probability(value: float) -> str:
    """Return a p value with two significant digits, or ``< 0.0001``."""
    return "< 0.0001" if value < 0.0001 else f"{value:.2g}"


def decimal(value: float) -> str:
    """Return a number with two decimals."""
    return _with_minus(f"{value:.2f}".replace("-0.00", "0.00"))


def duration(seconds: float) -> str:
    """Return seconds as text: two significant digits below 99.5, else whole; below 1 s in milliseconds."""
    value, unit = (seconds, "s") if seconds >= 1 else (1000 * seconds, "ms")
    return f"{value:.0f} {unit}" if value >= 99.5 else f"{value:.2g} {unit}"


def listed(names: Sequence[str]) -> str:
    """Return names as a list in a sentence: a, b and c."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} and {names[-1]}"


def listed_in_short(names: Sequence[str], most: int = 10) -> str:
    """Return names as a list in a sentence; after `most` names the rest is only counted."""
    if len(names) <= most:
        return listed(names)
    return f"{', '.join(names[:most])} and {len(names) - most:,} more"


def counted(count: int, noun: str) -> str:
    """Return a count with its noun, in the plural unless the count is 1."""
    if count == 1:
        return f"1 {noun}"
    ending = "es" if noun.endswith(("s", "ch", "x")) else "s"
    return f"{count:,} {noun}{ending}"


def anchor_of(key: str) -> str:
    """Return an object's anchor: ASCII letters, digits and hyphens, different for different keys."""
    slug = re.sub(r"[^a-z0-9]+", "-", key.lower()).strip("-")[:40]
    digest = hashlib.sha256(key.encode("utf-8")).hexdigest()[:8]
    return f"object-{slug}-{digest}" if slug else f"object-{digest}"


def place_in_view(row: float, column: float, height: int, width: int) -> str:
    """Return the position of a point in a picture on a grid of three by three, such as ``upper left``.

    `row` and `column` are in pixels from the upper left corner.
    """
    vertical = ("upper", "middle", "lower")[min(int(3 * row / height), 2)]
    horizontal = ("left", "centre", "right")[min(int(3 * column / width), 2)]
    if (vertical, horizontal) == ("middle", "centre"):
        return "centre"
    return f"{vertical} {horizontal}"


def _with_minus(number: str) -> str:
    return number.replace("-", _MINUS)
