"""Read and check the header of a PLY file before any row is read."""

from __future__ import annotations

import re
from dataclasses import dataclass

LONGEST = 1 << 16
"""Length of the longest header that is read, bytes."""

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
    """A PLY header.

    Attributes
    ----------
    ascii : bool
        Whether rows are text.
    rows : int
        Rows of all elements together.
    least_bytes : int
        Smallest number of bytes that the rows can take.
    length : int
        Length of the header, bytes.
    """

    ascii: bool
    rows: int
    least_bytes: int
    length: int


def read_ply_header(start: bytes) -> PlyHeader:
    """Read the header from the first `LONGEST` bytes of a file.

    Raises `ValueError` if the bytes hold no complete header, or the header has a count that is no number.
    """
    # If lines end in a carriage return only, a line feed after the header is data.
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
    """Raise `ValueError` if a file of `size` bytes (unpacked) is shorter than its header claims."""
    # The last line of a text may have no line end.
    if header.least_bytes > size - header.length + 1:
        raise ValueError(
            f"its header claims {header.rows} rows, which take {header.least_bytes} bytes at least, "
            f"and {max(size - header.length, 0)} bytes follow"
        )


def _count(words: list[str]) -> int:
    if len(words) != 3 or not words[2].isdecimal() or len(words[2]) > 18:
        raise ValueError(f"{' '.join(words)[:80]!r} has no count; 'element NAME COUNT' is needed")
    return int(words[2])


def _property_bytes(words: list[str], text: bool) -> int:  # noqa: FBT001
    """Return the smallest number of bytes of a property; as text, a digit and a separator."""
    if text:
        return 2
    if words[1:2] != ["list"]:
        return _SIZES.get(words[1] if len(words) > 1 else "", 1)
    return _SIZES.get(words[2] if len(words) > 2 else "", 1)
