"""The design of the study: all combinations of some choices, and a fraction of the others.

Every variant touches by fixation and by all kinds of random probing, so that the kind of random touches is crossed with
every other choice. Parts on the paper's set:

- ``recognition``: every combination of the recognition choices that matter, on the same touches.
- ``upstream``: the other choices in 32 runs of a two-level design of resolution IV: no main effect is confounded with an
  interaction of two choices. Each run has every kind of map output, so that interactions of the map output with any other
  choice are clear as well.
- ``training``: the map trained touch by touch, with every kind of map output and classifier settings.
- ``protocol``: known objects from new viewpoints, which is another question.
- ``further``: options without a column in the two-level design, varied one at a time, with every kind of map output.
- ``literal``: the variant nearest to the paper's words in every choice.
- ``default``: the package's default, if no other part has it.

Larger sets, for which views and touches take long, have the parts ``recognition``, ``further``, ``literal``, ``default``
and

- ``single``: every other choice varied one at a time, with every kind of map output.
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
"""The strategies of every variant, from the same viewpoints."""

FACTORIAL = (
    "map_output",
    "touch_scaling",
    "sequence_scaling",
    "sequence_extension",
    "wavelet_bands",
    "classifier_settings",
)
CROSSED = ("map_output", "classifier_settings")
"""Choices that are crossed with the parts ``training`` and ``protocol``."""
CROSSED_SINGLY = ("map_output",)
"""Choices that are crossed with the parts ``upstream``, ``further`` and ``single``."""

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
# On larger sets there are too many combinations of one test object per class.
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

Products of an odd number of five basic columns make a design of resolution IV in 32 runs (G. Box, W. Hunter and
J. Hunter, Statistics for Experimenters, chapter 6). The four options of the viewpoints take two basic columns and their
product AB. AB is also the column of some interactions, such as channels with sensor size (C times ABC), but of no other
choice. Choices with more than two options have their first two options in the design.
"""

VARIED_ALONE = ("viewpoints", *_COLUMNS)
"""The choices that part ``single`` varies."""

BASE: dict[str, str] = {choice.name: choice.base for choice in CHOICES}
"""The base of the design: the first option of every choice."""

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

Matlab's map of five units returns 1 for the nearest unit and 0 for the others. The paper names no scaling of features and
no limit of depth, and it used Matlab. Its reference 10 weights channels by points that people marked. Its random sensor
moves over the surface. For all other choices the base follows the paper's words.
"""


@dataclass(frozen=True)
class Variant:
    """One variant of the paper: an option of every choice.

    The name, such as ``r017``, is the first letter of the part and the index of the variant in the part.
    """

    name: str
    part: Part
    options: Options

    @property
    def values(self) -> Changes:
        """Parameters of all options of the variant."""
        values: dict[str, object] = {}
        for choice, option in self.options.items():
            values |= BY_NAME[choice].options[option]
        return values


def is_default(options: Mapping[str, Any]) -> bool:
    """Return whether the options of all choices equal the package's default parameters."""
    return all(options[choice.name] == choice.default for choice in CHOICES)


def is_literal(options: Mapping[str, Any]) -> bool:
    """Return whether the options of all choices equal those of the most literal variant."""
    return all(options[name] == option for name, option in LITERAL.items())


def is_base_but_for(options: Mapping[str, Any], names: Collection[str]) -> bool:
    """Return whether every choice outside of `names` has the base option of the design."""
    return all(options[name] == base for name, base in BASE.items() if name not in names)


def all_variants() -> list[Variant]:
    """Return the variants of all parts in order, without duplicates."""
    variants: dict[tuple[str, ...], Variant] = {}
    for part, make in _PARTS.items():
        fresh = [options for options in make() if tuple(options.values()) not in variants]
        for index, options in enumerate(fresh):
            variants[tuple(options.values())] = Variant(f"{part[0]}{index:03d}", part, options)
    return list(variants.values())


def variant_conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield one condition per variant of the parts for the run's set of objects.

    A condition changes only parameters that differ from the run, so that variants reuse tables of the run.
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
        level = 2 * basic["A"] + basic["B"]
        run = BASE | {"viewpoints": list(BY_NAME["viewpoints"].options)[level]}
        for name, column in _COLUMNS.items():
            # All columns are products of an odd number of factors, so that the run of zeros has the base of every choice.
            run[name] = list(BY_NAME[name].options)[sum(basic[letter] for letter in column) % 2]
        yield from _combinations(CROSSED_SINGLY, run)


def _alone(names: Iterable[str], first: int) -> Iterator[Options]:
    """Yield variants that differ from the base in one choice; options before index `first` are left out."""
    for name in names:
        for option in list(BY_NAME[name].options)[first:]:
            yield from _combinations(CROSSED_SINGLY, BASE | {name: option})


_PARTS: Mapping[Part, Callable[[], Iterable[Options]]] = {
    "recognition": lambda: _combinations(FACTORIAL, BASE),
    "upstream": _fraction,
    "training": lambda: _combinations(CROSSED, BASE | {"map_training": "online"}),
    "protocol": lambda: _combinations(CROSSED, BASE | {"protocol": "new_viewpoint"}),
    "further": lambda: _alone(_COLUMNS, 2),
    # Every variant has all kinds of random touches, also those of the literal variant.
    "literal": lambda: [LITERAL | {"random_probing": BASE["random_probing"]}],
    "single": lambda: _alone(VARIED_ALONE, 0),
    "default": lambda: [{choice.name: choice.default for choice in CHOICES}],
}
