"""Divide objects into blocks; one job processes one block."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence

SEVERAL = "several_objects"
"""The first part of the name of a block of at least two objects, where a block of one object has a class."""


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
        Sorted objects of each block by its name, in the order of the first objects. A block of one object has the name
        of the object; other blocks are `SEVERAL`, followed by the bits that their objects share, or by ``all``.
    """
    parts = sorted(_halve(sorted(objects), per_job, 0, ""))
    return {
        part[0] if len(part) == 1 else f"{SEVERAL}/{bits or 'all'}": part for part, bits in parts
    }


def _halve(
    members: Sequence[str], per_job: int, bit: int, bits: str
) -> Iterator[tuple[list[str], str]]:
    if len(members) <= per_job:
        yield from [(list(members), bits)] if members else []
        return
    for side in (0, 1):
        half = [key for key in members if _bit(key, bit) == side]
        yield from _halve(half, per_job, bit + 1, f"{bits}{side}")


def _bit(key: str, bit: int) -> int:
    return int.from_bytes(hashlib.sha256(key.encode()).digest(), "little") >> bit & 1
