"""Choose a sample of objects for a study."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

LEAST_OF_CLASS = 2
"""The least number of objects per class: one to train and one to test."""


def sample_objects(objects: Sequence[str], maximum: int) -> list[str]:
    """Choose objects evenly over the classes and within each class.

    Parameters
    ----------
    objects : sequence of str
        Objects, ``class/name``, sorted.
    maximum : int
        The intended number of objects. The result may have slightly more: each class keeps its rounded share, and at
        least `LEAST_OF_CLASS` objects.

    Returns
    -------
    list of str
        The chosen objects, or all objects if they are at most `maximum`.
    """
    if len(objects) <= maximum:
        return list(objects)
    chosen: list[str] = []
    for _, group in groupby(objects, key=lambda key: key.partition("/")[0]):
        members = list(group)
        share = round(maximum * len(members) / len(objects))
        count = min(max(share, LEAST_OF_CLASS), len(members))
        chosen += [members[index * len(members) // count] for index in range(count)]
    return chosen
