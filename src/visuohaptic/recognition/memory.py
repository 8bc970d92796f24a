"""What was fitted before, by a hash of what it was fitted on, so that nothing is fitted twice."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

Found = TypeVar("Found")

REMEMBERED_SEQUENCES = 20_000
"""Training sequences of inner folds whose fits are kept: some 100 MB."""


class FitMemory:
    """Remembers what was found of the same arrays and settings; the oldest go first.

    At most `most` is remembered, in all sizes together.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._held: dict[bytes, tuple[int, Any]] = {}

    def recall(self, known: tuple[object, ...], find: Callable[[], Found], size: int = 1) -> Found:
        """Give what `find` gives; it is called only where the arrays and settings `known` are new."""
        key = _digest(known)
        found = self._held.pop(key, None) or (size, find())
        self._held[key] = found
        while len(self._held) > 1 and sum(size for size, _ in self._held.values()) > self._most:
            del self._held[next(iter(self._held))]
        return found[1]


def _digest(known: tuple[object, ...]) -> bytes:
    content = hashlib.blake2b()
    for part in known:
        if isinstance(part, np.ndarray):
            content.update(repr(part.shape).encode() + part.tobytes())
        else:
            content.update(repr(part).encode())
    return content.digest()
