"""A policy with fields that are not allowed is one sentence."""

import pytest

from visuohaptic.active.policies import Policy
from visuohaptic.base.errors import RegistryError
from visuohaptic.fixations.probing import Strategy


def walk(view, touches):
    return view.places.points[len(touches)]


@pytest.mark.parametrize("bound", [0, -1.0, float("nan"), "long", None, True])
def test_a_bound_that_is_no_positive_number_is_one_sentence(bound):
    with pytest.raises(
        RegistryError, match=r"policy walk: longest_seconds is .*; a positive number"
    ):
        Policy("walk", "walk", walk, longest_seconds=bound)


@pytest.mark.parametrize("entry", [Policy, Strategy])
def test_a_treatment_of_places_out_of_reach_that_is_unknown_is_one_sentence(entry):
    with pytest.raises(
        RegistryError,
        match=r"y walk: unreachable is 'banana'; 'replace', 'skip', 'keep' or None is allowed\.$",
    ):
        entry("walk", "walk", walk, unreachable="banana")
