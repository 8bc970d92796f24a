"""Read STL files, binary and text, with both conventions for colours in binary files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray
from meshreaders.base.errors import MeshError
from meshreaders.companions import Companions
from meshreaders.content import BEGINNING, other_content
from meshreaders.formats.limits import check_lines
from meshreaders.formats.text_numbers import check_number, plain_lines
from meshreaders.parts import GREY, Part

_HEADER_BYTES = 84
_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_MAGICS = re.compile(rb"COLOR=(...)", re.DOTALL)
_FLAG = 1 << 15

# Any white space separates words. The name of a solid ends with its line, or where a face begins.
# Patterns begin with a small letter and the text is lower-case, because that is several times faster.
_NAME = re.compile(rb"(solid\b)(?:(?!\bfacet\s+normal\b)[^\n])*")
_CORNER = re.compile(rb"vertex(?:\s+(\S+\s+\S+\s+\S+))?")
_SOLID = re.compile(rb"solid", re.IGNORECASE)
_FACE_OR_END = re.compile(rb"facet|endsolid", re.IGNORECASE)
_END_OF_FACE = re.compile(rb"\bendloop\s+endfacet\b", re.IGNORECASE)
_CORNERS_AT_ONCE = 30_000
_BLOCK_BYTES = 1 << 20


def read_stl(data: bytes, companions: Companions) -> list[Part]:
    """Read an STL file as one part; its faces share no vertices.

    If the header of a binary file has ``COLOR=``, colours follow the convention of Magics, otherwise of VisCAM and
    SolidView (en.wikipedia.org/wiki/STL_(file_format), "Color in binary STL").

    The header of a binary file states the number of faces (StL interface specification, 3D Systems, 1989). Bytes behind
    the last face are noted and not read, as by numpy-stl and PrusaSlicer.

    Raises `MeshError` with the reason if a binary file is shorter than its header promises, holds more faces, or is of
    another kind. For a text, the numbers of faces and ends must be equal, and each face needs three corners.
    """
    promised = int.from_bytes(data[_HEADER_BYTES - 4 : _HEADER_BYTES], "little")
    size = _HEADER_BYTES + _FACE.itemsize * promised
    is_text = len(data) != size and _SOLID.search(data) and _FACE_OR_END.search(data)
    if len(data) == size or (not is_text and _goes_on(data, promised, size)):
        if len(data) > size:
            count = "1 byte" if len(data) == size + 1 else f"{len(data) - size} bytes"
            companions.notes.append(
                f"goes on for {count} behind its last face; that part is not read"
            )
        rows = np.frombuffer(data, _FACE, promised, _HEADER_BYTES)
        colours = _colours(data[:_HEADER_BYTES], rows["attribute"])
        points = np.empty((3 * len(rows), 3))
        points.reshape(-1, 3, 3)[:] = rows["corners"]
        return [_part(points, colours)]
    if not is_text:
        problem = "it is truncated" if len(data) < size else "it holds too much"
        raise MeshError(
            f"{problem}: its header promises {promised} faces, hence {size} bytes, and {len(data)} are there"
        )
    return [_part(_corners_of_text(data), None)]


def _goes_on(data: bytes, promised: int, size: int) -> bool:
    """Return whether bytes behind the promised faces are no faces, so that they may be left out."""
    behind = data[size:]
    whole_faces = len(behind) % _FACE.itemsize == 0 and behind.strip(b"\0")
    is_other = other_content(data[:BEGINNING], "stl") is not None
    return bool(promised and behind and not whole_faces and not is_other)


def _part(points: FloatArray, colours: NDArray[np.uint8] | None) -> Part:
    return Part(points, np.arange(len(points)).reshape(-1, 3), colours)


def _corners_of_text(data: bytes) -> NDArray[np.float64]:
    """Return the corners (3 f, 3) of a text file, face after face."""
    check_lines(data)
    closed, faces, corners, has_end = 0, 0, 0, False
    numbers = [np.empty((0, 3))]
    for part in _whole_faces(data):
        text = _NAME.sub(rb"\1 ", plain_lines(part).lower())
        ends = text.count(b"endfacet")
        closed, faces = closed + ends, faces + text.count(b"facet") - ends
        if b"solid" in text:
            has_end = text.rfind(b"endsolid") == text.rfind(b"solid") - len("end")
        matches = _CORNER.finditer(text)
        while block := [corner[1] for corner in islice(matches, _CORNERS_AT_ONCE)]:
            numbers.append(_numbers_of(block, corners))
            corners += len(block)
    if not has_end or (closed, corners) != (faces, 3 * faces):
        problem = "a face has more than 3 corners" if corners > 3 * faces else "it is truncated"
        raise MeshError(
            f"{problem}: it has {faces} faces, which need {3 * faces} corners, and {closed} ends of "
            f"faces, {corners} corners and {'an' if has_end else 'no'} end of the last solid"
        )
    return np.concatenate(numbers)


def _whole_faces(data: bytes) -> Iterator[bytes]:
    """Yield a text in blocks of at least one megabyte that end after a face."""
    start = 0
    while start < len(data):
        end = _END_OF_FACE.search(data, start + _BLOCK_BYTES)
        stop = end.end() if end else len(data)
        yield data[start:stop]
        start = stop


def _numbers_of(corners: list[bytes | None], before: int) -> NDArray[np.float64]:
    """Return corners (n, 3); raise `MeshError` with the face of the first wrong corner, after `before` corners."""
    for index, corner in enumerate(corners, before):
        if corner is None:
            raise MeshError(
                f"it is truncated: face {index // 3 + 1} has a corner of fewer than 3 numbers"
            )
    try:
        return np.fromstring(b" ".join(filter(None, corners)), sep=" ").reshape(-1, 3)
    except ValueError:
        for index, corner in enumerate(filter(None, corners), before):
            for word in corner.split():
                check_number(word, f"face {index // 3 + 1}")
        raise


def _colours(header: bytes, attributes: NDArray[np.uint16]) -> NDArray[np.uint8] | None:
    """Return the colours (f, 3), sRGB; None without colours."""
    magics = _MAGICS.search(header)
    flagged = (attributes & _FLAG) != 0
    coloured = ~flagged if magics else flagged
    if not magics and not coloured.any():
        return None
    # Programs that colour the whole solid set all attributes to 0.
    if magics and not attributes.any():
        coloured[:] = False
    shifts = (0, 5, 10) if magics else (10, 5, 0)
    default = np.frombuffer(magics[1], np.uint8) if magics else np.array(GREY, np.uint8)
    levels = np.rint(np.arange(32) * (255 / 31)).astype(np.uint8)
    colours = np.stack([levels[(attributes >> shift) & 31] for shift in shifts], axis=1)
    colours[~coloured] = default
    return colours
