"""Blocks of objects: those that one job takes through a phase."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence


def divide(objects: Iterable[str], per_job: int) -> dict[str, list[str]]:
    """Divide objects, ``class/name``, into blocks of at most `per_job`, sorted, each by the name of its first object.

    Too many objects are halved by a bit of each name's SHA-256, and so are the halves: an object stays in its block
    whatever others there are, and an object more or less changes one block. A block that grows too large becomes
    two, and two blocks that fit into one become one.
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
