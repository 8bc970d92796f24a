"""OBJ files, their indices checked and made plain and their concave polygons cut, for trimesh's reader."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from visuohaptic.errors import MeshError
from visuohaptic.geometry.arrays import Booleans, Integers
from visuohaptic.meshes.polygons import check_corners, cuts

_FACE = re.compile(rb"^f(?:[ \t]+([^\n#]*))?(#[^\n]*)?$", re.MULTILINE)
_VERTEX = re.compile(rb"^v ([^\n#]*)", re.MULTILINE)
_KINDS = (rb"^v ", rb"^vt ", rb"^vn ")  # in the order in which a corner names them
_OTHER_BLANKS = re.compile(rb"^(?:[ \t]+(?=(?:v|vt|vn|f)[ \t])|(?:v|vt|vn|f)\t)", re.MULTILINE)
_AFTER_BLANKS = re.compile(rb"^[ \t]*(v|vt|vn|f)[ \t]+", re.MULTILINE)


def checked_obj(data: bytes) -> bytes:
    """Give the file, or one of the same surface that trimesh reads as it is meant.

    Concave polygons become triangles, indices that count backwards become plain ones, and faces of
    fewer than three corners go, which have no area.

    Raises `MeshError` with the reason alone, if a face names no vertex (vertices are counted from 1);
    `ValueError` where a number is none.
    """
    file = _File(_plain_lines(data))
    if not file.faces:
        return file.data
    check_corners(file.corners + 1, file.vertices, first=1)
    cut = file.cuts()
    odd = np.flatnonzero((file.counts < 3) | file.counts_backwards | file.with_comment)
    written = {}
    for place in {*map(int, odd), *cut}:
        tokens = file.tokens(place)
        whole = [range(len(tokens))] if len(tokens) >= 3 else []
        rows = cut.get(place, whole)
        lines = [b"f " + b" ".join(tokens[corner] for corner in row) for row in rows]
        written[place] = b"\n".join(lines)
    return file.with_faces(written)


def _plain_lines(data: bytes) -> bytes:
    """Join lines that go on, and write the beginnings of others in the one way that trimesh knows."""
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    data = data.replace(b"\\\n", b" ")
    return _AFTER_BLANKS.sub(rb"\1 ", data) if _OTHER_BLANKS.search(data) else data


@dataclass(frozen=True)
class _File:
    data: bytes

    @cached_property
    def faces(self) -> list[re.Match[bytes]]:
        return list(_FACE.finditer(self.data))

    @cached_property
    def counts(self) -> Integers:
        """Corners of each face."""
        return np.array([len((face[1] or b"").split()) for face in self.faces], dtype=np.int64)

    @cached_property
    def _numbers(self) -> Integers:
        """The vertex that each corner names, as it stands there."""
        text = b" ".join(face[1] or b"" for face in self.faces)
        words = re.sub(rb"/\S*", b"", text).split()
        return np.fromiter(map(int, words), np.int64, len(words))

    @cached_property
    def counts_backwards(self) -> Booleans:
        """Whether a face has a negative index, which counts from where the face stands."""
        return np.array([b"-" in (face[1] or b"") for face in self.faces], dtype=bool)

    @cached_property
    def with_comment(self) -> Booleans:
        """Whether a comment follows a face, which trimesh would take for a corner."""
        return np.array([face[2] is not None for face in self.faces], dtype=bool)

    @cached_property
    def _counted(self) -> list[Integers]:
        """Vertices, texture coordinates and normals above each face."""
        starts = [face.start() for face in self.faces]
        return [
            np.searchsorted(
                [one.start() for one in re.finditer(kind, self.data, re.MULTILINE)], starts
            )
            for kind in _KINDS
        ]

    @cached_property
    def vertices(self) -> int:
        return sum(1 for _ in _VERTEX.finditer(self.data))

    @cached_property
    def corners(self) -> Integers:
        """The vertex of each corner, counted from 0; -1 and below where there is none."""
        numbers = self._numbers
        if not self.counts_backwards.any():
            return numbers - 1
        above = np.repeat(self._counted[0], self.counts)
        return np.where(numbers < 0, above + numbers, numbers - 1)

    def tokens(self, place: int) -> list[bytes]:
        """Give the corners of a face as they stand there, but counted from the beginning."""
        tokens = (self.faces[place][1] or b"").split()
        if not self.counts_backwards[place]:
            return tokens
        above = [int(counted[place]) for counted in self._counted]
        return [
            b"/".join(
                b"%d" % (count + 1 + int(number)) if number.startswith(b"-") else number
                for number, count in zip(token.split(b"/"), above, strict=False)
            )
            for token in tokens
        ]

    def cuts(self) -> dict[int, Integers]:
        if self.counts.max() <= 3:
            return {}
        rows = [vertex[1].split()[:3] for vertex in _VERTEX.finditer(self.data)]
        short = next((row for row in rows if len(row) < 3), None)
        if short is not None:
            raise MeshError(f"a vertex has {len(short)} coordinates; 3 are needed")
        numbers = (float(word) for row in rows for word in row)
        points = np.fromiter(numbers, np.float64, 3 * len(rows)).reshape(-1, 3)
        return cuts(points, self.corners, self.counts)

    def with_faces(self, written: dict[int, bytes]) -> bytes:
        """Put other lines in the place of some faces."""
        pieces, end = [], 0
        for place in sorted(written):
            start, after = self.faces[place].span()
            pieces += [self.data[end:start], written[place]]
            end = after
        return b"".join([*pieces, self.data[end:]])
