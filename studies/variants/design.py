"""Which variants are run: all combinations of some choices, and a fraction of the others.

Every variant touches by fixation and by all kinds of random probing, so which random touches fixation
is compared with is crossed with every other choice. Parts on the paper's set:

- ``recognition``: every combination of the recognition choices that matter, on the same touches.
- ``upstream``: the other choices in 32 runs of a two-level design of resolution IV (main effects are
  clear of all interactions of two), each with every kind of map output, so that the interactions of
  the map output with any other choice are clear as well.
- ``training``: the map trained touch by touch, with every kind of map output and classifier settings.
- ``protocol``: known objects from new viewpoints, which is another question.
- ``further``: options for which the two-level design has no column, each varied alone, with every
  kind of map output.
- ``literal``: the variant that is nearest to the paper's words in every choice.
- ``default``: the package's default, where no other part has it.

Larger sets, where views and touches take long, have the parts ``recognition``, ``further``,
``literal``, ``default`` and

- ``single``: every other choice varied alone, each with every kind of map output.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any, Literal

from variants.choices import BY_NAME, CHOICES, OPPONENTS
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.study import Changes, Condition

Part = Literal[
    "recognition", "upstream", "training", "protocol", "further", "literal", "single", "default"
]
Options = Mapping[str, str]
"""An option of every choice, by the choice's name."""

STRATEGIES = ("fixation", *OPPONENTS.values())
"""What every variant touches by, on the same viewpoints."""

FACTORIAL = (
    "map_output",
    "touch_scaling",
    "sequence_scaling",
    "sequence_extension",
    "wavelet_bands",
    "classifier_settings",
)
CROSSED = ("map_output", "classifier_settings")
"""What is crossed with the parts ``training`` and ``protocol``."""
CROSSED_SINGLY = ("map_output",)
"""What is crossed with the parts ``upstream``, ``further`` and ``single``."""

PARTS_ON_PAPER_SET: tuple[Part, ...] = (
    "recognition",
    "upstream",
    "training",
    "protocol",
    "further",
    "literal",
    "default",
)
PARTS_ON_OTHERS: tuple[Part, ...] = ("recognition", "further", "literal", "single", "default")
# All combinations of a test object a class are too many on larger sets.
_FOLDS: Changes = {"recognition.protocol.protocol": "grouped_folds"}

_COLUMNS: Mapping[str, str] = {
    "channels": "C",
    "saliency_operator": "D",
    "inhibition": "E",
    "sensor_size": "ABC",
    "sensor_normal": "ABD",
    "imprint_stretch": "ABE",
    "contourlet_filters": "ACD",
    "imprint_extension": "ACE",
    "deviation": "ADE",
    "focus_radius": "BCD",
    "reach": "BCE",
    "unreachable": "BDE",
    "order": "CDE",
}
"""Each choice's column in the two-level design: the product of these basic columns.

Products of an odd number of five basic columns make a design of resolution IV in 32 runs (G. Box,
W. Hunter and J. Hunter, Statistics for Experimenters, chapter 6). The four options of the
viewpoints take two basic columns and their product AB. No other choice has that column, but
interactions such as that of the channels and the sensor's size have (C times ABC). Of choices with
more than two options the first two are in the design.
"""

VARIED_ALONE = ("viewpoints", *_COLUMNS)
"""What part ``single`` varies."""

BASE: dict[str, str] = {choice.name: choice.base for choice in CHOICES}
"""The base of the design."""

LITERAL = BASE | {
    "map_output": "one_hot",
    "touch_scaling": "none",
    "sequence_scaling": "none",
    "classifier_settings": "matlab",
    "channels": "eight_fitted",
    "reach": "none",
    "random_probing": "walk",
}
"""The most literal variant.

A map of five units, as Matlab's, gives 1 for the nearest and 0 for the others; the paper names no
scaling of features and no limit of depth; it used Matlab; its reference 10 gives channels weights by people's
points; its random sensor moves over the surface. Elsewhere the base is what the words say.
"""


@dataclass(frozen=True)
class Variant:
    """One variant of the paper, such as ``r017``, the letter of its part and its place there: an option of every choice."""

    name: str
    part: Part
    options: Options

    @property
    def values(self) -> Changes:
        """The parameters of all its options."""
        values: dict[str, object] = {}
        for choice, option in self.options.items():
            values |= BY_NAME[choice].options[option]
        return values


def is_default(options: Mapping[str, Any]) -> bool:
    """Whether options, of all choices, are those of the package's own parameters."""
    return all(options[choice.name] == choice.default for choice in CHOICES)


def is_literal(options: Mapping[str, Any]) -> bool:
    """Whether options, of all choices, are those of the most literal variant."""
    return all(options[name] == option for name, option in LITERAL.items())


def is_base_but_for(options: Mapping[str, Any], names: Collection[str]) -> bool:
    """Whether every choice, but for some, has the option that is the base of the design."""
    return all(options[name] == base for name, base in BASE.items() if name not in names)


def all_variants() -> list[Variant]:
    """Give the variants of all parts in order; no two are the same."""
    found: dict[tuple[str, ...], Variant] = {}
    for part, make in _PARTS.items():
        fresh = [options for options in make() if tuple(options.values()) not in found]
        for place, options in enumerate(fresh):
            found[tuple(options.values())] = Variant(f"{part[0]}{place:03d}", part, options)
    return list(found.values())


def variant_conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Give a condition for each variant of the parts that the run's objects allow.

    A condition changes what differs from the run, so that variants share what the run has made.
    """
    on_paper_set = run.meshes.set == "paper"
    same: dict[str, object] = {
        "recognition.pipelines": ("paper",),
        "recognition.classifiers": tuple(TABLE_1),
        "probing.strategies": STRATEGIES,
    }
    new_objects = {} if on_paper_set else _FOLDS
    parts = PARTS_ON_PAPER_SET if on_paper_set else PARTS_ON_OTHERS
    for variant in all_variants():
        if variant.part in parts:
            values = {**variant.values, **new_objects}.items()
            changes = {path: value for path, value in values if attrgetter(path)(run) != value}
            yield Condition(variant.name, {**changes, **same})


def _combinations(names: tuple[str, ...], others: Options) -> Iterator[Options]:
    for options in itertools.product(*(BY_NAME[name].options for name in names)):
        yield {**others, **dict(zip(names, options, strict=True))}


def _fraction() -> Iterator[Options]:
    for levels in itertools.product((0, 1), repeat=5):
        basic = dict(zip("ABCDE", levels, strict=True))
        place = 2 * basic["A"] + basic["B"]
        run = BASE | {"viewpoints": list(BY_NAME["viewpoints"].options)[place]}
        for name, column in _COLUMNS.items():
            # With odd products, the run of all zeros has the base of every choice.
            run[name] = list(BY_NAME[name].options)[sum(basic[letter] for letter in column) % 2]
        yield from _combinations(CROSSED_SINGLY, run)


def _alone(names: Iterable[str], first: int) -> Iterator[Options]:
    """Vary each choice alone, from one of its options on."""
    for name in names:
        for option in list(BY_NAME[name].options)[first:]:
            yield from _combinations(CROSSED_SINGLY, BASE | {name: option})


_PARTS: Mapping[Part, Callable[[], Iterable[Options]]] = {
    "recognition": lambda: _combinations(FACTORIAL, BASE),
    "upstream": _fraction,
    "training": lambda: _combinations(CROSSED, BASE | {"map_training": "online"}),
    "protocol": lambda: _combinations(CROSSED, BASE | {"protocol": "new_viewpoint"}),
    "further": lambda: _alone(_COLUMNS, 2),
    # Its random touches, as all kinds, are in every variant.
    "literal": lambda: [LITERAL | {"random_probing": BASE["random_probing"]}],
    "single": lambda: _alone(VARIED_ALONE, 0),
    "default": lambda: [{choice.name: choice.default for choice in CHOICES}],
}
