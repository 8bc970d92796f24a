"""Read numbers of text formats, separated by any white space."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError

_LONGEST_SHOWN = 40
_BLOCK_BYTES = 1 << 18
_LINE_FEED = ord("\n")
_BLANK = re.compile(rb"\s")
_IS_BLANK = np.isin(np.arange(256), list(b" \t\n\v\f\r"))  # by the value of a byte


def plain_lines(data: bytes) -> bytes:
    r"""Return a text with all ends of lines (``\r\n``, ``\r``) as ``\n``."""
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def blocks_of_lines(data: bytes, start: int = 0) -> Iterator[bytes]:
    """Yield the rest of a text, from byte `start`, in blocks of whole lines of about 260 kB."""
    while start < len(data):
        stop = data.find(b"\n", start + _BLOCK_BYTES) + 1 or len(data)
        yield data[start:stop]
        start = stop


def blocks_of_words(data: bytes, start: int = 0) -> Iterator[bytes]:
    """Yield the rest of a text, from byte `start`, in blocks of whole words of about 260 kB.

    A block ends at the first white space after 260 kB, so a line may continue in the next block.
    """
    while start < len(data):
        blank = _BLANK.search(data, start + _BLOCK_BYTES)
        stop = len(data) if blank is None else blank.end()
        yield data[start:stop]
        start = stop


def numbers_by_line(text: bytes, first_line: int) -> tuple[FloatArray, IntArray]:
    """Read the numbers of a text and count them per line.

    Parameters
    ----------
    text : bytes
        Whole words; lines end in a line feed.
    first_line : int
        Number of the first line of `text` in its file.

    Returns
    -------
    numbers : numpy.ndarray
        Shape (n,), float64.
    widths : numpy.ndarray
        Shape (lines,), int64: number of numbers per line.

    Raises
    ------
    MeshError
        If a word is no number; the message has line and word.
    """
    widths = _words_by_line(text)
    if not widths.any():
        # NumPy reads a number from a text of only white space.
        return np.empty(0), widths
    try:
        numbers = np.fromstring(text, dtype=np.float64, sep=" ")
    except ValueError:
        _refuse_wrong_word(text, first_line)
        raise
    # NumPy reads "1-2" as two numbers.
    if len(numbers) != widths.sum():
        _refuse_wrong_word(text, first_line)
        raise MeshError(f"numbers from line {first_line} on are not separated by blanks")
    return numbers, widths


def _words_by_line(text: bytes) -> IntArray:
    """Count the words of each line, shape (lines,)."""
    characters = np.frombuffer(text, np.uint8)
    blank = _IS_BLANK[characters]
    is_start = ~blank
    is_start[1:] &= blank[:-1]
    words = np.flatnonzero(is_start)
    ends = np.flatnonzero(characters == _LINE_FEED)
    words_before = np.searchsorted(words, ends)
    if not text.endswith(b"\n"):
        words_before = np.append(words_before, len(words))
    return np.diff(words_before, prepend=0)


def _refuse_wrong_word(text: bytes, first_line: int) -> None:
    for line, words in enumerate(map(bytes.split, text.split(b"\n")), first_line):
        for word in words:
            check_number(word, f"line {line}")


def check_number(word: bytes, label: str) -> None:
    """Raise `MeshError` if a word is no number; `label` names its position."""
    try:
        float(word)
    except ValueError:
        text = word[:_LONGEST_SHOWN].decode("latin-1")
        advice = "; decimal points are needed, not commas" if b"," in word else ""
        raise MeshError(f"{label} holds {text!r}, which is no number{advice}") from None
