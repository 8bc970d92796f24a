"""STL files, checked to be whole, for trimesh's reader."""

from __future__ import annotations

import codecs
import re
from collections import Counter

from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.limits import check_lines, check_parts

_HEADER_BYTES = 84
_FACE_BYTES = 50
_WORD = re.compile(
    rb"^[ \t]*(solid|facet|vertex|endfacet|endsolid)\b", re.MULTILINE | re.IGNORECASE
)
_NAME = re.compile(rb"^([ \t]*(?:end)?solid\b)[^\n]*$", re.MULTILINE | re.IGNORECASE)


def checked_stl(data: bytes) -> bytes:
    """Give the file, without the names of solids where it is text.

    Raises `MeshError` with the reason alone, if it holds other than it promises: a binary file by the
    count of its header, a text by the ends of its solids and faces.
    """
    promised = int.from_bytes(data[_HEADER_BYTES - 4 : _HEADER_BYTES], "little")
    size = _HEADER_BYTES + _FACE_BYTES * promised
    if len(data) == size:
        return data
    data = data.removeprefix(codecs.BOM_UTF8)
    words = Counter(word.lower() for word in _WORD.findall(data))
    solids, faces, corners = words[b"solid"], words[b"facet"], words[b"vertex"]
    if not (solids and faces):
        what = "it is truncated" if len(data) < size else "it holds too much"
        raise MeshError(
            f"{what}: its header promises {promised} faces, hence {size} bytes, and {len(data)} are there"
        )
    check_lines(data)
    check_parts(solids, "solids")
    ends, closed = words[b"endsolid"], words[b"endfacet"]
    if (ends, closed, corners) != (solids, faces, 3 * faces):
        raise MeshError(
            f"it is truncated: {solids} solids, {faces} faces and so {3 * faces} corners are promised, "
            f"and {ends} ends of solids, {closed} of faces and {corners} corners are there"
        )
    # trimesh looks for words such as "vertex" in names too.
    return _NAME.sub(rb"\1", data)
