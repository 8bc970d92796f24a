"""Divide objects into blocks; one job processes one block."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence


def divide(objects: Iterable[str], per_job: int) -> dict[str, list[str]]:
    """Divide objects into blocks of at most `per_job` objects.

    Sets of more than `per_job` objects are halved, again and again, by the bits of the SHA-256 of each name. So adding
    or removing an object changes only one block, splits a block in two, or merges two blocks.

    Parameters
    ----------
    objects : iterable of str
        Objects, ``class/name``.
    per_job : int
        The largest number of objects of a block.

    Returns
    -------
    dict of str to list of str
        Sorted objects of each block, by the name of the first.
    """
    return {part[0]: part for part in sorted(_halve(sorted(objects), per_job, 0))}


def _halve(members: Sequence[str], per_job: int, bit: int) -> Iterator[list[str]]:
    if len(members) <= per_job:
        yield from [list(members)] if members else []
        return
    for side in (0, 1):
        yield from _halve([key for key in members if _bit(key, bit) == side], per_job, bit + 1)


def _bit(key: str, bit: int) -> int:
    return int.from_bytes(hashlib.sha256(key.encode()).digest(), "little") >> bit & 1
