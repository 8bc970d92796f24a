"""Numbers of text formats, parted by any white space."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError

_LONGEST_SHOWN = 40
_BLOCK_BYTES = 1 << 18


def plain_lines(data: bytes) -> bytes:
    r"""Return a text whose lines end in ``\n`` only, whichever system wrote it."""
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def blocks_of_lines(data: bytes, start: int = 0) -> Iterator[bytes]:
    """Yield a text from a place on in blocks of whole lines, each of some 260 kB."""
    while start < len(data):
        stop = data.find(b"\n", start + _BLOCK_BYTES) + 1 or len(data)
        yield data[start:stop]
        start = stop


def numbers_of(text: bytes, first_line: int) -> FloatArray:
    """Return the numbers of a text, shape (n,), whose first line is line `first_line` of its file.

    Raises `MeshError` with the reason, which names the line and the word that is no number.
    """
    try:
        # NumPy reads a number from white space without any.
        return np.fromstring(text, dtype=np.float64, sep=" ") if text.strip() else np.empty(0)
    except ValueError:
        for line, words in enumerate(map(bytes.split, text.split(b"\n")), first_line):
            for word in words:
                check_number(word, f"line {line}")
        raise


def check_number(word: bytes, place: str) -> None:
    """Refuse a word that is no number, with the place where it stands."""
    try:
        float(word)
    except ValueError:
        shown = word[:_LONGEST_SHOWN].decode("latin-1")
        point = "; decimal points are needed, not commas" if b"," in word else ""
        raise MeshError(f"{place} holds {shown!r}, which is no number{point}") from None
