"""Votes, ties among them."""

import numpy as np
import pytest

from visuohaptic.recognition.voting import vote_credit


@pytest.mark.parametrize(
    ("predicted", "credit"),
    [
        ([0, 0, 0, 0], 1),
        ([0, 0, 1, 2], 1),
        ([0, 0, 1, 1], 1 / 2),
        ([0, 1, 2, 3], 1 / 4),
        ([1, 1, 2, 2], 0),
        ([0, 1, 1, 2], 0),
    ],
)
def test_credit_is_what_tossing_for_a_tie_gives_on_average(predicted, credit):
    owners, found = vote_credit(np.full(4, 3), np.array(predicted), np.array([9, 9, 9, 0]))
    assert owners.tolist() == [3]
    assert found.tolist() == [credit]
