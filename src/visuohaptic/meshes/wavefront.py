"""Statements of OBJ and MTL files: lines without the ways in which programs write them differently."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator, Sequence

_BLOCK_BYTES = 1 << 20  # lines of so many bytes are in memory at a time
_LONGEST_SHOWN = 40
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_COMMENT = re.compile(r"\s+#.*")
# What Microsoft's C library writes, old and new, for numbers that are none.
_NO_NUMBER = re.compile(rb"[-+]?(?:\d\.#(?:QNAN|SNAN|IND|INF)\d*|nan\([a-z]+\))", re.IGNORECASE)


def statements(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the number of each line, from 1, and its bytes, continued lines as one.

    Lines end in LF, CR LF or CR. A line that ends in a backslash goes on in the next one, except a
    comment, whose last word may be a Windows folder. Comments and empty lines are yielded as well.
    """
    first, waiting = 0, list[bytes]()
    for number, line in enumerate(_lines(data), 1):
        if waiting and line.lstrip().startswith(b"#"):
            continue
        if b"\\" in line and b"#" not in line and (start := line.rstrip()).endswith(b"\\"):
            first = first if waiting else number
            waiting.append(start[:-1])
        elif waiting:
            yield first, b" ".join([*waiting, line])
            waiting = []
        else:
            yield number, line
    if waiting:
        yield first, b" ".join(waiting)


def as_utf_8(data: bytes) -> bytes:
    """Return a text without its byte order mark; one in UTF-16, as PowerShell writes, becomes UTF-8.

    Raises `UnicodeDecodeError` where UTF-16 is broken.
    """
    if data.startswith(_UTF_16):
        data = data.decode("utf-16").encode()
    return data.removeprefix(codecs.BOM_UTF8)


def numbers_of(line: bytes) -> list[bytes]:
    """Return the words after the first one of a line of numbers, up to its comment."""
    if b"#" in line or b"(" in line:
        line = _NO_NUMBER.sub(b"nan", line).partition(b"#")[0]
    return line.split()[1:]


def rest_of(line: bytes) -> str:
    """Return what follows the first word of a line, which may be a name with blanks or a ``#``.

    Text is UTF-8 or, where it is not, Windows-1252 or Latin-1.
    """
    _, *rest = line.split(None, 1)
    raw = rest[0].strip() if rest else b""
    for encoding in ("utf-8", "cp1252"):
        try:
            return raw.decode(encoding)
        except UnicodeDecodeError:
            continue
    return raw.decode("latin-1")


def name_without_comment(name: str) -> str:
    """Return a name up to a ``#`` that follows a blank, which begins a comment or is part of the name."""
    return _COMMENT.sub("", name)


def wrong_number(words: Sequence[bytes], kind: type[float | int] = float) -> str:
    """Return a clause that names the first of some words, or of their parts between ``/``, that is none."""
    for number in (number for word in words for number in word.split(b"/")):
        try:
            kind(number or b"0")
        except ValueError:
            what = "whole number" if kind is int else "number"
            why = "; numbers need a decimal point" if b"," in number else ""
            return f"{shown(number)} is no {what}{why}"
    return "a number is too large"


def shown(word: bytes) -> str:
    """Return a word, or its beginning, as messages show it."""
    cut = "…" if len(word) > _LONGEST_SHOWN else ""
    return repr(word[:_LONGEST_SHOWN].decode("utf-8", "backslashreplace") + cut)


def _lines(data: bytes) -> Iterator[bytes]:
    end = b"\n" if b"\n" in data else b"\r"
    start = 0
    while start < len(data):
        stop = data.find(end, start + _BLOCK_BYTES) + 1 or len(data)
        yield from data[start:stop].splitlines()
        start = stop
