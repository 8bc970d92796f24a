"""What a PLY file says of itself, before anything of it is believed."""

from __future__ import annotations

import re
from dataclasses import dataclass

LONGEST = 1 << 16
"""Bytes of the longest header that is looked at."""

_SIZES = {
    **dict.fromkeys(("char", "uchar", "int8", "uint8"), 1),
    **dict.fromkeys(("short", "ushort", "int16", "uint16"), 2),
    **dict.fromkeys(("int", "uint", "float", "int32", "uint32", "float32"), 4),
    **dict.fromkeys(("double", "float64"), 8),
}
_END = re.compile(rb"[\r\n]end_header[ \t]*(?:\r?\n|$)")
_END_OF_OLD_MAC = re.compile(rb"\rend_header[ \t]*(?:\r|$)")


@dataclass(frozen=True)
class PlyHeader:
    """A header of `length` bytes: whether text follows, how many rows of all elements, and their least bytes."""

    ascii: bool
    rows: int
    least_bytes: int
    length: int


def read_ply_header(start: bytes) -> PlyHeader:
    """Read a header from a file's first `LONGEST` bytes; raises `ValueError` if it is none."""
    # Where lines end in a carriage return only, a line feed behind the header is data.
    old_mac = start[3:4] == b"\r" and start[4:5] != b"\n"
    end = (_END_OF_OLD_MAC if old_mac else _END).search(start)
    if not start.startswith(b"ply") or end is None:
        raise ValueError(f"it has no header that ends within {LONGEST} bytes")
    form = ""
    counts: list[tuple[int, int]] = []
    for line in start[: end.start() + 1].decode("latin-1").splitlines():
        words = line.split()
        match words[:1]:
            case ["format"]:
                form = words[1] if len(words) > 1 else ""
            case ["element"]:
                counts.append((_count(words), 0))
            case ["property"] if counts:
                count, row_bytes = counts[-1]
                counts[-1] = (count, row_bytes + _property_bytes(words, form == "ascii"))
            case _:
                pass
    rows = sum(count for count, _ in counts)
    least = sum(count * max(row_bytes, 1) for count, row_bytes in counts)
    return PlyHeader(form == "ascii", rows, least, end.end())


def check_ply_size(header: PlyHeader, size: int) -> None:
    """Refuse, by `ValueError`, a file of fewer bytes, unpacked, than its header says."""
    # The last line of a text may lack its end.
    if header.least_bytes > size - header.length + 1:
        raise ValueError(
            f"its header claims {header.rows} rows, which take {header.least_bytes} bytes at least, "
            f"and {max(size - header.length, 0)} bytes follow"
        )


def _count(words: list[str]) -> int:
    if len(words) != 3 or not words[2].isdecimal() or len(words[2]) > 18:
        raise ValueError(f"{' '.join(words)[:80]!r} counts nothing")
    return int(words[2])


def _property_bytes(words: list[str], text: bool) -> int:  # noqa: FBT001
    """Give the fewest bytes of a property; a number and what follows it take two as text."""
    if text:
        return 2
    if words[1:2] != ["list"]:
        return _SIZES.get(words[1] if len(words) > 1 else "", 1)
    return _SIZES.get(words[2] if len(words) > 2 else "", 1)
