"""Sign-change test of the mean of paired differences, and the interval of all means that the test accepts.

The test of a mean m takes the differences minus m, and changes their signs in all ways. Its p value is the share of sign
changes with an absolute weighted mean at least as large as the observed one. A sign change divides the objects into two
groups: objects that change and objects that keep their sign. The absolute mean is at least as large exactly if m lies
between the weighted means of both groups, between which the mean of all objects lies, too. So p falls steadily
with the distance of m from the mean of all objects, and the ends of the interval are order statistics of the means of
groups (J. Hartigan, Journal of the American Statistical Association 64, 1969: typical values). A test statistic divided
by its standard error gives the same test for equal weights: sign changes keep the sum of squares.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.seeds import spawn_generator

_ROUNDING = 5e-13
"""Sums of weighted differences below this size count as 0; the weights sum to 1."""
_BITS = 8
_MOST_ENUMERATED = 62


@dataclass(frozen=True)
class SignChangeTest:
    """Result of `sign_change_test`.

    `low` and `high` are the least and the greatest mean with a p value of at least the significance level. They are
    infinite where no mean is rejected. `p_value` is that of mean 0. `exact` is True if all sign changes were taken,
    False if a random sample was.
    """

    low: float
    high: float
    p_value: float
    exact: bool


def sign_change_test(
    differences: FloatArray, shares: FloatArray, permutations: int, significance: float
) -> SignChangeTest:
    """Test means of paired differences by sign changes.

    Parameters
    ----------
    differences : array (o,)
        One finite difference per object; at least one object.
    shares : array (o,)
        The objects' weights, positive, with sum 1.
    permutations : int
        The largest number of sign changes. If all 2**o sign changes are at most `permutations`, all are taken.
        Otherwise `permutations` sign changes are drawn, and the observed signs are added. The drawn sample depends only
        on `permutations` and o.
    significance : float
        The p value below which a mean is rejected, in (0, 1).

    Returns
    -------
    SignChangeTest
        `p_value` is below `significance` exactly if 0 lies outside `low` to `high`.
    """
    changed, exact = _sign_changes(len(differences), permutations)
    products = differences * shares
    low, high = _group_means(products, shares, changed)
    observed = 0 if exact else 1
    rank = _rank(significance, len(low), observed)
    mean = float(np.add.reduce(products))
    if abs(mean) <= 2 * _ROUNDING:
        p_value = 1.0
    else:
        reached = np.count_nonzero(low <= 0 if mean > 0 else high >= 0)
        p_value = float((reached + observed) / (len(low) + observed))
    return SignChangeTest(_smallest(low, rank), -_smallest(-high, rank), p_value, exact)


@lru_cache(maxsize=16)
def _sign_changes(count: int, permutations: int) -> tuple[NDArray[np.uint8], bool]:
    """Return sign changes as bits (bytes, changes), a bit per object, and whether these are all."""
    # All sign changes are halved: a change and its opposite form the same two groups.
    exact = count <= _MOST_ENUMERATED and 2**count <= permutations
    if exact:
        numbers = np.arange(2 ** (count - 1), dtype="<u8")
        bits = numbers.view(np.uint8).reshape(len(numbers), 8)[:, : -(-count // _BITS)]
    else:
        generator = spawn_generator(0, "sign changes", count)
        signs = generator.choice([-1.0, 1.0], size=(permutations, count))
        bits = np.packbits(signs < 0, axis=1, bitorder="little")
    return np.ascontiguousarray(bits.T), exact


def _group_means(
    products: FloatArray, shares: FloatArray, changed: NDArray[np.uint8]
) -> tuple[FloatArray, FloatArray]:
    """Return the smaller and the larger of both groups' means (changes,); without an object in a group, infinities."""
    smaller = np.full(changed.shape[1], np.inf)
    larger = np.full(changed.shape[1], -np.inf)
    for group in (changed, ~changed):
        sums, weights = _group_sums(products, group), _group_sums(shares, group)
        sums[np.abs(sums) <= _ROUNDING] = 0.0
        is_empty = weights == 0
        means = sums / np.where(is_empty, 1.0, weights)
        smaller = np.minimum(smaller, np.where(is_empty, -np.inf, means))
        larger = np.maximum(larger, np.where(is_empty, np.inf, means))
    return smaller, larger


def _group_sums(values: FloatArray, group: NDArray[np.uint8]) -> FloatArray:
    """Sum the values (o,) of each group's objects; a group is a column of bits (bytes, groups)."""
    # The sums of all 256 choices of eight values are looked up by byte. Only sums, in a fixed order: these have the
    # same bits on every processor.
    total = np.zeros(group.shape[1])
    for number, byte in enumerate(group):
        table = np.zeros(1)
        for value in values[_BITS * number : _BITS * (number + 1)]:
            table = np.concatenate([table, table + value])
        total += table.take(byte & np.uint8(len(table) - 1))
    return total


def _rank(significance: float, count: int, observed: int) -> int:
    """Return the smallest number of reached sign changes, of `count`, with a p value of at least `significance`."""
    rank = max(0, int(significance * (count + observed)) - observed - 1)
    while (rank + observed) / (count + observed) < significance:
        rank += 1
    return rank


def _smallest(values: FloatArray, rank: int) -> float:
    """Return the value of the given rank, counted from 1; minus infinity for rank 0."""
    return float(np.partition(values, rank - 1)[rank - 1]) if rank else -np.inf
