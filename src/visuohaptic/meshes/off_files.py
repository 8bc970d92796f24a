"""OFF files (Object File Format of Geomview) with colours of vertices and faces."""

from __future__ import annotations

import re
from array import array
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.colours import as_bytes, mean_of_corners
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.limits import check_lines
from visuohaptic.meshes.parts import GREY, Part
from visuohaptic.meshes.polygons import check_corners, index_runs, named_triangles
from visuohaptic.meshes.text_numbers import (
    blocks_of_lines,
    blocks_of_words,
    numbers_by_line,
    plain_lines,
)

# ModelNet has files whose counts follow the keyword without a blank.
_KEYWORD = re.compile(rb"\s*(ST)?(C?N?|NC)(4?)OFF(?=[\s\d]|$)", re.IGNORECASE)
# Two or three counts on a line, or three with any white space between them.
_COUNTS = re.compile(
    rb"\s*(?:(\d+)[ \t]+(\d+)(?:[ \t]+\d+)?[ \t]*(?:\n|$)|(\d+)\s+(\d+)\s+\d+(?=\s|$))"
)
_COMMENT = re.compile(rb"#[^\n]*")
_AT_ONCE = 1 << 14  # faces


@dataclass(frozen=True)
class _Header:
    """A header of `length` bytes: numbers of vertices and faces, and whether vertices have locations, colours and normals."""

    places: bool
    colours: bool
    normals: bool
    vertices: int
    faces: int
    length: int


@dataclass(frozen=True)
class _Faces:
    """Corners of all faces (n,), corners per face (f,), whether a face is coloured (f,), and the colours of these (c, 3)."""

    corners: IntArray
    counts: IntArray
    colours: FloatArray
    coloured: NDArray[np.bool_]


def read_off(data: bytes, companions: Companions) -> list[Part]:
    """Read an OFF file as one part, polygons cut into triangles.

    White space of any kind divides numbers; colours of faces need a line per face. Colours are numbers
    to 255 or, where none is above 1, shares.

    Raises `MeshError`, with the reason only, if rows are other than the header promises, a word is no
    number, a face names no vertex, or the file is binary.
    """
    text = plain_lines(data)
    del data
    check_lines(text)
    if b"#" in text:
        text = _COMMENT.sub(b"", text)
    header = _read_header(text)
    blocks = _read_by_lines(header, text)
    if blocks is None:
        numbers, widths = _read_numbers(header, text)
        # The numbers take the memory of the text.
        del text
        blocks = _divide_numbers(header, numbers, widths)
        del numbers, widths
    else:
        del text
    rows, faces = _join_blocks(*blocks)
    points = np.ascontiguousarray(rows[:, :3])
    check_corners(faces.corners, len(points))
    named, pieces = named_triangles(points, faces.corners, faces.counts)
    if header.places:
        companions.notes.append("has coordinates on an image that OFF can't name")
    return [Part(points, named, _colours(faces, pieces, _vertex_colours(header, rows), named))]


def _read_header(text: bytes) -> _Header:
    keyword = _KEYWORD.match(text)
    start = keyword.end() if keyword else 0
    if text[start:].lstrip(b" \t").startswith(b"BINARY"):
        raise MeshError("it is binary OFF, which is not read; export it as text")
    counts = _COUNTS.match(text, start)
    if keyword is None and counts is None:
        raise MeshError("its first line is not OFF, COFF or NOFF")
    if counts is None:
        raise MeshError("its header does not promise a number of vertices and one of faces")
    places, extras, dimensions = keyword.groups() if keyword else (None, b"", b"")
    if dimensions:
        raise MeshError("it has vertices of 4 dimensions; 3 are needed")
    vertices, faces = (int(count) for count in counts.groups() if count is not None)
    return _Header(
        places is not None,
        b"C" in extras.upper(),
        b"N" in extras.upper(),
        vertices,
        faces,
        counts.end(),
    )


def _read_by_lines(header: _Header, text: bytes) -> tuple[list[FloatArray], list[_Faces]] | None:
    """Read vertices and faces in blocks; None where some row does not have a line of its own."""
    if text.count(b"\n", header.length) + 1 < header.vertices + header.faces:
        return None
    line = 1 + text.count(b"\n", 0, header.length)
    rows: list[FloatArray] = []
    faces: list[_Faces] = []
    waiting, first = header.vertices, 0
    for block in blocks_of_lines(text, header.length):
        numbers, widths = numbers_by_line(block, line)
        widths = widths[widths > 0]
        line += block.count(b"\n")
        if waiting and len(widths):
            columns = rows[0].shape[1] if rows else int(widths[0])
            here = min(waiting, len(widths))
            if columns < 3 or (widths[:here] != columns).any():
                return None
            rows.append(numbers[: here * columns].reshape(-1, columns))
            numbers, widths = numbers[here * columns :], widths[here:]
            waiting -= here
        if first + len(widths) > header.faces:
            return None
        try:
            faces.append(_faces_of_rows(numbers, widths, first))
        except MeshError:
            # Lines may break within faces. If the file is broken, `_divide_numbers` says where.
            return None
        first += len(widths)
    if waiting or first < header.faces or not rows:
        return None
    return rows, faces


def _join_blocks(rows: list[FloatArray], faces: list[_Faces]) -> tuple[FloatArray, _Faces]:
    points = np.concatenate(rows)
    # Each block is freed when its numbers have been joined.
    rows.clear()
    return points, _Faces(
        np.concatenate([one.corners for one in faces]),
        np.concatenate([one.counts for one in faces]),
        np.concatenate([one.colours for one in faces]),
        np.concatenate([one.coloured for one in faces]),
    )


def _read_numbers(header: _Header, text: bytes) -> tuple[FloatArray, NDArray[np.int32]]:
    """Return all numbers (n,) behind the header, and how many each line has that has any."""
    numbers, widths = bytearray(), bytearray()
    line, unfinished = 1 + text.count(b"\n", 0, header.length), 0
    for block in blocks_of_words(text, header.length):
        here, of_lines = numbers_by_line(block, line)
        numbers += here.tobytes()
        line += block.count(b"\n")
        of_lines[0] += unfinished
        unfinished = 0
        if not block.endswith(b"\n"):
            unfinished, of_lines = int(of_lines[-1]), of_lines[:-1]
        widths += of_lines[of_lines > 0].astype(np.int32).tobytes()
    widths += np.array([unfinished] if unfinished else [], dtype=np.int32).tobytes()
    return np.frombuffer(numbers), np.frombuffer(widths, np.int32)


def _divide_numbers(
    header: _Header, numbers: FloatArray, widths: NDArray[np.int32]
) -> tuple[list[FloatArray], list[_Faces]]:
    """Divide numbers that lines do not divide into rows of vertices and blocks of faces."""
    columns = _columns(header, widths)
    if header.vertices * columns > len(numbers):
        raise _wrong("it is truncated", header, widths)
    rows = numbers[: header.vertices * columns].reshape(-1, columns)
    of_faces, lines = numbers[rows.size :], _lines_behind(widths, rows.size)
    if lines is None or len(lines) != header.faces:
        lines = _widths_by_counts(header, of_faces, lines)
    blocks, end = [_no_faces()], 0
    for first in range(0, len(lines), _AT_ONCE):
        here = lines[first : first + _AT_ONCE].astype(np.int64)
        start, end = end, end + int(here.sum())
        blocks.append(_faces_of_rows(of_faces[start:end], here, first))
    # A copy: a view would keep the numbers of faces in memory.
    return [rows.copy()], blocks


def _columns(header: _Header, widths: NDArray[np.int32]) -> int:
    """Return how many numbers a vertex has: by its line, if all vertices have lines of one length, else by the keyword."""
    of_vertices = widths[: header.vertices]
    lines = len(widths) >= header.vertices + header.faces
    if len(of_vertices) and lines and (of_vertices == of_vertices[0]).all() and of_vertices[0] >= 3:
        return int(of_vertices[0])
    return 3 + 3 * header.normals + 4 * header.colours + 2 * header.places


def _lines_behind(widths: NDArray[np.int32], count: int) -> NDArray[np.int32] | None:
    """Return the widths of the lines behind the first `count` numbers; None where a line holds both."""
    ends = np.cumsum(widths, dtype=np.int64)
    lines = int(np.searchsorted(ends, count, side="right"))
    whole = count == 0 or (lines > 0 and ends[lines - 1] == count)
    return widths[lines:] if whole else None


def _widths_by_counts(
    header: _Header, numbers: FloatArray, lines: NDArray[np.int32] | None
) -> NDArray[np.int32]:
    """Return how many numbers (f,) each face has, by the counts of corners; faces that no lines divide have no colours."""
    widths, place = array("i"), 0
    for face in range(header.faces):
        count = numbers.item(place) if place < len(numbers) else np.inf
        end = place + 1 + count
        if count < 0 or end > len(numbers):
            raise _wrong("it is truncated", header, lines, face)
        if not count.is_integer():
            raise MeshError(f"a face holds {count:g}; whole numbers are needed")
        widths.append(1 + int(count))
        place = int(end)
    if place < len(numbers):
        raise _wrong("it holds too much", header, lines)
    return np.frombuffer(widths, np.int32)


def _no_faces() -> _Faces:
    none = np.empty(0, np.int64)
    return _Faces(none, none, np.empty((0, 3)), np.empty(0, bool))


def _faces_of_rows(numbers: FloatArray, widths: IntArray, first: int) -> _Faces:
    """Read faces from `numbers` (n,), row after row, with `widths` (f,) numbers each: a count, corners, and maybe a colour."""
    starts = np.cumsum(widths) - widths
    counts = _whole(numbers[starts])
    wrong = np.flatnonzero((counts < 0) | (counts >= widths))
    if len(wrong):
        face = wrong[0]
        raise MeshError(
            f"face {first + face} promises {counts[face]} corners, and {widths[face] - 1} numbers follow"
        )
    corners = _whole(numbers[index_runs(starts + 1, counts)])
    # A single number is an index into a table of colours that Geomview has.
    coloured = widths - 1 - counts >= 3
    behind = (starts + 1 + counts)[coloured]
    return _Faces(corners, counts, numbers[behind[:, None] + np.arange(3)], coloured)


def _whole(numbers: FloatArray) -> IntArray:
    wrong = np.flatnonzero(~(np.abs(numbers) < 2**53) | (np.floor(numbers) != numbers))
    if len(wrong):
        raise MeshError(f"a face holds {numbers[wrong[0]]:g}; whole numbers are needed")
    return numbers.astype(np.int64)


def _colours(
    faces: _Faces, pieces: NDArray[np.int32], of_vertices: NDArray[np.uint8] | None, named: IntArray
) -> NDArray[np.uint8] | None:
    """Return the colours (t, 3) of triangles: of their face, else of their vertices, else grey; None without colours."""
    colours = mean_of_corners(of_vertices, named)
    if not faces.coloured.any():
        return colours
    of_faces = np.zeros((len(faces.counts), 3), np.uint8)
    of_faces[faces.coloured] = as_bytes(faces.colours)
    others = np.array(GREY, np.uint8) if colours is None else colours
    coloured = np.repeat(faces.coloured, pieces)[:, None]
    return np.where(coloured, np.repeat(of_faces, pieces, axis=0), others)


def _vertex_colours(header: _Header, rows: FloatArray) -> NDArray[np.uint8] | None:
    """Return the colours (v, 3); normals stand before, coordinates on an image behind them."""
    start, end = 3 + 3 * header.normals, rows.shape[1] - 2 * header.places
    extras = rows[:, start:end]
    if extras.shape[1] not in {3, 4}:
        return None
    # Under the plain keyword they may be normals.
    if not header.colours and (
        header.normals or not (extras >= 0).all() or (extras[:, :3] != np.rint(extras[:, :3])).any()
    ):
        return None
    return as_bytes(extras[:, :3])


def _wrong(
    what: str, header: _Header, widths: NDArray[np.int32] | None, face: int | None = None
) -> MeshError:
    lines = "" if widths is None else f", and {len(widths)} lines follow"
    at = "" if face is None else f" (at face {face})"
    return MeshError(
        f"{what}: its header promises {header.vertices} vertices and {header.faces} faces{lines}{at}"
    )
