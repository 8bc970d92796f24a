"""A learning policy with a bound or a name that is not allowed is one sentence."""

import pytest

import visuohaptic as vh
from touch_curves.choosing import ADAPTIVE
from visuohaptic.base.errors import RegistryError


def fail(*_):
    raise KeyError("imprint")


def test_a_bound_that_is_no_positive_number_is_one_sentence():
    with pytest.raises(
        RegistryError, match="learning policy plain: longest_seconds is 0; a positive"
    ):
        vh.LearningPolicy("plain", fail, longest_seconds=0)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("random", "a probing strategy has that name"),
        ("seek_relief", "a probing strategy has that name"),
        (ADAPTIVE.name, "each name"),
    ],
)
def test_a_name_that_is_taken_is_refused(name, sentence):
    with pytest.raises(RegistryError, match=sentence):
        vh.register(vh.LearningPolicy(name, fail))
