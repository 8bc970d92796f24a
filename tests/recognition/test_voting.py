"""Votes, ties among them."""

import numpy as np
import pytest

from visuohaptic.recognition.voting import evenly_spaced_subsets, vote_credit


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


@pytest.mark.parametrize("total", range(1, 33))
def test_subsets_are_even_distinct_each_index_is_in_as_many_and_the_first_hold_all(total):
    for count in range(1, total + 1):
        subsets = evenly_spaced_subsets(total, count)
        assert len(np.unique(subsets, axis=0)) == len(subsets)
        assert len(set(np.bincount(subsets.ravel(), minlength=total))) == 1
        gaps = np.diff(subsets, axis=1, append=subsets[:, :1] + total)
        assert set(gaps.ravel()) <= {total // count, -(-total // count)}
        assert len(set(subsets[: -(-total // count)].ravel())) == total
