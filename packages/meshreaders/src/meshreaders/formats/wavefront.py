"""Split OBJ and MTL files into statements, in all spellings that programs write."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator, Sequence

_BLOCK_BYTES = 1 << 20  # size of the lines in memory at a time
_LONGEST_SHOWN = 40
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_COMMENT = re.compile(r"\s+#.*")
# Spellings of NaN and infinity in Microsoft's C library, old and new.
_NO_NUMBER = re.compile(rb"[-+]?(?:\d\.#(?:QNAN|SNAN|IND|INF)\d*|nan\([a-z]+\))", re.IGNORECASE)


def statements(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield each line with its number, from 1; continued lines are joined.

    Lines end in LF, CR LF or CR. A line that ends in a backslash continues in the next line. Comments never continue:
    their last word may be a Windows folder. Comments and empty lines are also yielded.
    """
    first, continued = 0, list[bytes]()
    for number, line in enumerate(_lines(data), 1):
        if continued and line.lstrip().startswith(b"#"):
            continue
        if b"\\" in line and b"#" not in line and (start := line.rstrip()).endswith(b"\\"):
            first = first if continued else number
            continued.append(start[:-1])
        elif continued:
            yield first, b" ".join([*continued, line])
            continued = []
        else:
            yield number, line
    if continued:
        yield first, b" ".join(continued)


def as_utf_8(data: bytes) -> bytes:
    """Return a text in UTF-8 without byte order mark; UTF-16, as PowerShell writes it, is converted.

    Raises `UnicodeDecodeError` if UTF-16 is broken.
    """
    if data.startswith(_UTF_16):
        data = data.decode("utf-16").encode()
    return data.removeprefix(codecs.BOM_UTF8)


def numbers_of(line: bytes) -> list[bytes]:
    """Return the words of a line after its first word, without a comment."""
    if b"#" in line or b"(" in line:
        line = _NO_NUMBER.sub(b"nan", line).partition(b"#")[0]
    return line.split()[1:]


def rest_of(line: bytes) -> str:
    """Return the text after the first word of a line: a name, which may have blanks or a ``#``.

    The text is decoded as UTF-8, else as Windows-1252, else as Latin-1.
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
    """Return a name without the text from `` #`` on, which may be a comment."""
    return _COMMENT.sub("", name)


def wrong_number(words: Sequence[bytes], kind: type[float | int] = float) -> str:
    """Return a clause that names the first word, or part of a word between ``/``, that is no number."""
    for number in (number for word in words for number in word.split(b"/")):
        try:
            kind(number or b"0")
        except ValueError:
            kind_name = "whole number" if kind is int else "number"
            advice = "; numbers need a decimal point" if b"," in number else ""
            return f"{quoted(number)} is no {kind_name}{advice}"
    return "a number is too large"


def quoted(word: bytes) -> str:
    """Return a word for messages, shortened."""
    cut = "…" if len(word) > _LONGEST_SHOWN else ""
    return repr(word[:_LONGEST_SHOWN].decode("utf-8", "backslashreplace") + cut)


def _lines(data: bytes) -> Iterator[bytes]:
    end = b"\n" if b"\n" in data else b"\r"
    start = 0
    while start < len(data):
        stop = data.find(end, start + _BLOCK_BYTES) + 1 or len(data)
        yield from data[start:stop].splitlines()
        start = stop
