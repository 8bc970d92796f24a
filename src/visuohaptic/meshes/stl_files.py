"""STL files, binary and text, with the two ways in which programs put colours into binary ones."""

from __future__ import annotations

import re
from array import array

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.limits import check_lines
from visuohaptic.meshes.parts import GREY, Part
from visuohaptic.meshes.text_numbers import check_number, plain_lines

_HEADER_BYTES = 84
_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_MAGICS = re.compile(rb"COLOR=(...)", re.DOTALL)
_FLAG = 1 << 15

# White space of any kind parts words. The name of a solid ends with its line, or where a face begins.
_NAME = re.compile(rb"\b((?:end)?solid)\b(?:(?!\bfacet\s+normal\b)[^\n])*", re.IGNORECASE)
_ENDS = re.compile(rb"\b(?:end)?solid\b", re.IGNORECASE)
_FACET = re.compile(rb"\bfacet\b", re.IGNORECASE)
_END_OF_FACET = re.compile(rb"\bendfacet\b", re.IGNORECASE)
_CORNER = re.compile(rb"\bvertex\b(?:\s+(\S+)\s+(\S+)\s+(\S+))?", re.IGNORECASE)


def read_stl(data: bytes, companions: Companions) -> list[Part]:  # noqa: ARG001 - the signature of all readers
    """Read an STL file as one part, whose faces share no vertices.

    Colours of a binary file are read as VisCAM and SolidView write them, and where the header holds
    ``COLOR=`` as Magics does (en.wikipedia.org/wiki/STL_(file_format), "Color in binary STL").

    Raises `MeshError`, with the reason only, if a binary file has another size than its header
    promises, or a text other numbers of faces, corners and ends.
    """
    promised = int.from_bytes(data[_HEADER_BYTES - 4 : _HEADER_BYTES], "little")
    size = _HEADER_BYTES + _FACE.itemsize * promised
    if len(data) == size:
        rows = np.frombuffer(data, _FACE, offset=_HEADER_BYTES)
        colours = _colours(data[:_HEADER_BYTES], rows["attribute"])
        return [_part(rows["corners"].reshape(-1, 3), colours)]
    text = _NAME.sub(rb"\1 ", plain_lines(data))
    ends = _ENDS.findall(text)
    if not ends or not _FACET.search(text):
        what = "it is truncated" if len(data) < size else "it holds too much"
        raise MeshError(
            f"{what}: its header promises {promised} faces, hence {size} bytes, and {len(data)} are there"
        )
    return [_part(_corners_of_text(text, ended=ends[-1].lower() == b"endsolid"), None)]


def _part(vertices: NDArray[np.floating], colours: NDArray[np.uint8] | None) -> Part:
    points = vertices.astype(np.float64)
    return Part(points, np.arange(len(points)).reshape(-1, 3), colours)


def _corners_of_text(text: bytes, *, ended: bool) -> NDArray[np.float64]:
    """Return the corners, shape (3 f, 3), face after face."""
    check_lines(text)
    faces, closed = len(_FACET.findall(text)), len(_END_OF_FACET.findall(text))
    numbers, corners = array("d"), 0
    for corner in _CORNER.finditer(text):
        corners += 1
        if corner[1] is None:
            raise MeshError(f"it is truncated: corner {corners} has fewer than 3 numbers")
        try:
            numbers.extend(map(float, corner.groups()))
        except ValueError:
            for word in corner.groups():
                check_number(word, f"face {-(-corners // 3)}")
    if not ended or (closed, corners) != (faces, 3 * faces):
        raise MeshError(
            f"it is truncated: {faces} faces and so {3 * faces} corners are promised, and {closed} ends of "
            f"faces, {corners} corners and {'an' if ended else 'no'} end of the last solid are there"
        )
    return np.frombuffer(numbers, np.float64).reshape(-1, 3)


def _colours(header: bytes, attributes: NDArray[np.uint16]) -> NDArray[np.uint8] | None:
    """Return the colours (f, 3), sRGB; None where no face has one."""
    magics = _MAGICS.search(header)
    flagged = (attributes & _FLAG) != 0
    own = ~flagged if magics else flagged
    if not magics and not own.any():
        return None
    # Programs that give the whole solid one colour leave the attributes 0.
    if magics and not attributes.any():
        own[:] = False
    shifts = (0, 5, 10) if magics else (10, 5, 0)
    others = np.frombuffer(magics[1], np.uint8) if magics else np.array(GREY, np.uint8)
    channels = [(attributes >> shift) & 31 for shift in shifts]
    colours = np.rint(np.stack(channels, axis=1) * (255 / 31)).astype(np.uint8)
    return np.where(own[:, None], colours, others)
