"""Read the statements of an OBJ file into arrays.

The format is described in appendix B1 of the manual of Wavefront's Advanced Visualizer.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from itertools import repeat

import numpy as np

from meshreaders.base.errors import MeshError
from meshreaders.formats.wavefront import numbers_of, quoted, rest_of, statements, wrong_number

MOST_SHOWN = 3
"""Largest number of names in a message."""

_REFUSED = {
    b"surf": "a free-form surface",
    b"bzp": "a Bézier patch",
    b"bsp": "a B-spline patch",
    b"cdp": "a Cardinal patch",
    b"call": "a call of another file",
    b"csh": "a command",
}
_WITHOUT_AREA = {b"p": "points", b"l": "lines", b"curv": "curves"}
# Normals, names, and attributes of free-form elements, lines or rendering.
_PASSED_OVER = frozenset(
    b"vn vp g o s mg curv2 cstype deg bmat step parm trim hole scrv sp end con bevel c_interp d_interp "
    b"lod shadow_obj trace_obj ctech stech res cdc".split()
)


def _integers() -> array[int]:
    return array("i")


@dataclass
class Polygons:
    """Polygons of one material.

    Attributes
    ----------
    corners : array of int
        Index of the vertex, from 1, per corner, polygon after polygon.
    coordinates : array of int
        Index of the image coordinates, from 1, per corner; 0 for a corner without. The array ends with the last
        polygon that has image coordinates.
    counts : array of int
        Number of corners per polygon.
    lines : array of int
        Line number in the file per polygon.
    """

    corners: array[int] = field(default_factory=_integers)
    coordinates: array[int] = field(default_factory=_integers)
    counts: array[int] = field(default_factory=_integers)
    lines: array[int] = field(default_factory=_integers)


@dataclass
class ObjStatements:
    """The statements of an OBJ file, in arrays that grow without a second copy.

    Attributes
    ----------
    points : array of float
        Three coordinates per vertex.
    colours : array of float
        Three numbers per vertex, NaN where a vertex has no colour. The array ends with the last vertex
        that has a colour.
    sevenths : array of float
        The seventh number per vertex, NaN where a vertex has none. The array ends with the last vertex that has one.
    coordinates : array of float
        Two numbers per image coordinates (``vt``).
    polygons : dict
        `Polygons` per name of a material, "" for none, in the order in which materials are first used.
    libraries : dict
        The texts after ``mtllib`` as keys, in the order of the file.
    without_area : dict
        Number of elements per kind without a surface, such as points.
    unknown : dict
        First line number per unknown word, for up to `MOST_SHOWN` words.
    material : str
        Name of the material of the next polygon.
    """

    points: array[float] = field(default_factory=lambda: array("d"))
    colours: array[float] = field(default_factory=lambda: array("f"))
    sevenths: array[float] = field(default_factory=lambda: array("f"))
    coordinates: array[float] = field(default_factory=lambda: array("d"))
    polygons: dict[str, Polygons] = field(default_factory=dict)
    libraries: dict[str, None] = field(default_factory=dict)
    without_area: dict[str, int] = field(default_factory=dict)
    unknown: dict[str, int] = field(default_factory=dict)
    material: str = ""

    def add(self, line: bytes, number: int) -> None:
        """Add the statement of a line; `number` is the number of the line in the file.

        Raises `MeshError` with the reason, or `ValueError` or `OverflowError` if a word is no number.
        """
        words = line.split(None, 1)
        word = words[0] if words else b"#"
        if word == b"v":
            self._add_vertex(numbers_of(line))
        elif word in {b"f", b"fo"}:
            self._add_polygon(numbers_of(line), number)
        elif word == b"vt":
            self._add_coordinates(numbers_of(line))
        elif word not in _PASSED_OVER and not word.startswith(b"#"):
            self._add_rare(word, line, number)

    def _add_vertex(self, numbers: list[bytes]) -> None:
        self.points.extend(map(float, numbers[:3]))
        if len(numbers) < 3:
            raise MeshError(f"a vertex has {len(numbers)} coordinates; 3 are needed")
        if len(numbers) >= 6:
            self.colours.extend(repeat(np.nan, len(self.points) - 3 - len(self.colours)))
            # Eight numbers are x, y, z, weight, red, green, blue and alpha; seven may have a weight or alpha.
            first = 4 if len(numbers) == 8 else 3
            self.colours.extend(map(float, numbers[first : first + 3]))
            if len(numbers) == 7:
                self.sevenths.extend(
                    repeat(np.nan, len(self.colours) // 3 - 1 - len(self.sevenths))
                )
                self.sevenths.append(float(numbers[6]))

    def _add_coordinates(self, numbers: list[bytes]) -> None:
        if not numbers:
            raise MeshError("image coordinates have no number; 2 are needed")
        self.coordinates.extend(map(float, (*numbers, b"0")[:2]))

    def _add_polygon(self, words: list[bytes], line: int) -> None:
        rows = [[int(number or 0) for number in word.split(b"/")] for word in words]
        if len(rows) < 3:
            return
        if max(map(len, rows)) > 3:
            raise MeshError("a corner of a face has more than 3 numbers")
        polygons = self.polygons.get(self.material)
        if polygons is None:
            polygons = self.polygons[self.material] = Polygons()
        corners = [row[0] for row in rows]
        coordinates = [row[1] if len(row) > 1 else 0 for row in rows]
        if any(coordinates):
            polygons.coordinates.extend(
                repeat(0, len(polygons.corners) - len(polygons.coordinates))
            )
            polygons.coordinates.extend(_from_first(coordinates, len(self.coordinates) // 2))
        polygons.corners.extend(_from_first(corners, len(self.points) // 3))
        polygons.counts.append(len(rows))
        polygons.lines.append(line)

    def _add_rare(self, word: bytes, line: bytes, number: int) -> None:
        """Add a statement other than a vertex, image coordinates or a polygon."""
        lower = word.lower()
        if lower == b"usemtl":
            self.material = rest_of(line)
        elif lower == b"mtllib":
            self.libraries[rest_of(line)] = None
        elif lower in _REFUSED:
            raise MeshError(f"{lower.decode()}, {_REFUSED[lower]}, is not read; export polygons")
        elif lower in _WITHOUT_AREA:
            kind = _WITHOUT_AREA[lower]
            self.without_area[kind] = self.without_area.get(kind, 0) + 1
        elif lower != word:
            self.add(line.replace(word, lower, 1), number)
        elif _is_number(word):
            raise MeshError(f"the line begins with the number {quoted(word)}; a word is needed")
        elif len(self.unknown) < MOST_SHOWN:
            self.unknown.setdefault(quoted(word), number)


def read_statements(data: bytes) -> ObjStatements:
    """Read the statements of an OBJ file in UTF-8 or another encoding that contains ASCII.

    Raises `MeshError`, with line and word, if a word is no number, a row has too few numbers, or a statement
    describes a surface that is no polygon.
    """
    result = ObjStatements()
    for number, line in statements(data):
        try:
            result.add(line, number)
        except MeshError as error:
            raise MeshError(f"line {number}: {error}") from None
        except (ValueError, OverflowError):
            kind = int if line.lstrip()[:1] in b"fF" else float
            reason = wrong_number(numbers_of(line), kind)
            raise MeshError(f"line {number}: {reason}") from None
    return result


def _from_first(numbers: list[int], count: int) -> list[int]:
    """Return indices from 1; negative indices count from the end, so that -1 is the last of `count` rows."""
    if min(numbers) >= 0:
        return numbers
    return [count + 1 + number if number < 0 else number for number in numbers]


def _is_number(word: bytes) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
