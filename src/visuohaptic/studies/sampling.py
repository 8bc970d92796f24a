"""Which objects a study measures where there are many."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

LEAST_OF_CLASS = 2
"""One object to train and one to test."""


def sample_objects(objects: Sequence[str], maximum: int) -> list[str]:
    """Choose at most so many of sorted objects, ``class/name``, evenly spread over the classes and within each.

    Every class keeps its share, rounded, and `LEAST_OF_CLASS` where it has so many; so there may be
    some more than `maximum`.
    """
    if len(objects) <= maximum:
        return list(objects)
    chosen: list[str] = []
    for _, group in groupby(objects, key=lambda key: key.partition("/")[0]):
        members = list(group)
        share = round(maximum * len(members) / len(objects))
        count = min(max(share, LEAST_OF_CLASS), len(members))
        chosen += [members[place * len(members) // count] for place in range(count)]
    return chosen
