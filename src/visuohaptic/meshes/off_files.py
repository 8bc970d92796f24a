"""OFF files (Object File Format of Geomview) with colours of vertices and faces."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.colours import as_bytes, mean_of_corners
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.limits import check_lines
from visuohaptic.meshes.parts import GREY, Part
from visuohaptic.meshes.polygons import check_corners, named_triangles
from visuohaptic.meshes.text_numbers import blocks_of_lines, numbers_of, plain_lines

# ModelNet has files whose counts follow the keyword without a blank.
_KEYWORD = re.compile(rb"\s*(ST)?(C?N?|NC)(4?)OFF(?=[\s\d]|$)", re.IGNORECASE)
# Two or three counts on a line, or three that white space of any kind parts.
_COUNTS = re.compile(
    rb"\s*(?:(\d+)[ \t]+(\d+)(?:[ \t]+\d+)?[ \t]*(?:\n|$)|(\d+)\s+(\d+)\s+\d+(?=\s|$))"
)
_COMMENT = re.compile(rb"#[^\n]*")


@dataclass(frozen=True)
class _Header:
    """What a header says: extras of each vertex, numbers of rows, and where they begin."""

    places: bool
    colours: bool
    normals: bool
    vertices: int
    faces: int
    length: int


@dataclass(frozen=True)
class _Faces:
    """Corners, their number per face, the numbers behind the corners of coloured faces, (c, 3), and which are coloured."""

    corners: IntArray
    counts: IntArray
    colours: FloatArray
    coloured: NDArray[np.bool_]


def read_off(data: bytes, companions: Companions) -> list[Part]:
    """Read an OFF file as one part, polygons cut into triangles.

    White space of any kind parts numbers; colours of faces need a line per face. Colours are numbers
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
        rows, faces = _read_flowing(header, text)
    else:
        # What has been read takes the memory of the text.
        del text
        rows, faces = _join_blocks(*blocks)
    points = np.ascontiguousarray(rows[:, :3])
    check_corners(faces.corners, len(points))
    named, pieces = named_triangles(points, faces.corners, faces.counts)
    colours = mean_of_corners(_vertex_colours(header, rows), named)
    if faces.coloured.any():
        of_faces = np.zeros((len(faces.counts), 3), np.uint8)
        of_faces[faces.coloured] = as_bytes(faces.colours)
        others = np.array(GREY, np.uint8) if colours is None else colours
        coloured = np.repeat(faces.coloured, pieces)[:, None]
        colours = np.where(coloured, np.repeat(of_faces, pieces, axis=0), others)
    if header.places:
        companions.notes.append("has coordinates on an image that OFF can't name")
    return [Part(points, named, colours)]


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
    """Read vertices and faces that have a line each, block after block; None where others are there."""
    line = 1 + text.count(b"\n", 0, header.length)
    rows: list[FloatArray] = []
    faces: list[_Faces] = []
    waiting, first = header.vertices, 0
    for block in blocks_of_lines(text, header.length):
        numbers, widths = numbers_of(block, line), _widths(block)
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
        faces.append(_faces_of_lines(numbers, widths, first))
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


def _read_flowing(header: _Header, text: bytes) -> tuple[FloatArray, _Faces]:
    """Read numbers that white space of any kind parts; all are in memory at once."""
    body = text[header.length :]
    numbers = numbers_of(body, 1 + text.count(b"\n", 0, header.length))
    widths = _widths(body)
    columns = _columns(header, widths)
    if header.vertices * columns > len(numbers):
        raise _wrong("it is truncated", header, widths)
    rows = numbers[: header.vertices * columns].reshape(-1, columns)
    return rows, _read_faces(header, numbers[rows.size :], _behind(widths, rows.size))


def _widths(text: bytes) -> IntArray:
    """Return how many words each line has that has any."""
    counts = (len(line.split()) for line in text.split(b"\n"))
    return np.fromiter(filter(None, counts), dtype=np.int64)


def _columns(header: _Header, widths: IntArray) -> int:
    """Return how many numbers a vertex has: those of its line where each has one, else as the keyword says."""
    of_vertices = widths[: header.vertices]
    lines = len(widths) >= header.vertices + header.faces
    if len(of_vertices) and lines and (of_vertices == of_vertices[0]).all() and of_vertices[0] >= 3:
        return int(of_vertices[0])
    return 3 + 3 * header.normals + 4 * header.colours + 2 * header.places


def _behind(widths: IntArray, count: int) -> IntArray | None:
    """Return the widths of the lines behind some numbers; None where these end within a line."""
    ends = np.cumsum(widths)
    lines = int(np.searchsorted(ends, count, side="right"))
    whole = count == 0 or (lines > 0 and ends[lines - 1] == count)
    return widths[lines:] if whole else None


def _read_faces(header: _Header, numbers: FloatArray, widths: IntArray | None) -> _Faces:
    if widths is None or len(widths) != header.faces:
        return _parted_by_counts(header, numbers, widths)
    return _faces_of_lines(numbers, widths, 0)


def _faces_of_lines(numbers: FloatArray, widths: IntArray, first: int) -> _Faces:
    """Read faces of a line each, the first of which has a number in sentences."""
    starts = np.cumsum(widths) - widths
    counts = _whole(numbers[starts])
    wrong = np.flatnonzero((counts < 0) | (counts >= widths))
    if len(wrong):
        place = wrong[0]
        raise MeshError(
            f"face {first + place} promises {counts[place]} corners, and {widths[place] - 1} numbers follow"
        )
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    corners = numbers[np.repeat(starts + 1, counts) + within]
    # A single number is a place in a table of colours that Geomview has.
    coloured = widths - 1 - counts >= 3
    behind = (starts + 1 + counts)[coloured]
    colours = numbers[behind[:, None] + np.arange(3)]
    return _Faces(_whole(corners), counts, colours, coloured)


def _parted_by_counts(header: _Header, numbers: FloatArray, widths: IntArray | None) -> _Faces:
    """Read faces that do not have a line each, hence no colours."""
    place, counts, corners = 0, [], [np.empty(0)]
    for face in range(header.faces):
        count = int(_whole(numbers[place : place + 1]).sum())  # 0 behind the last
        if count < 0 or place + count >= len(numbers):
            raise _wrong("it is truncated", header, widths, face)
        counts.append(count)
        corners.append(numbers[place + 1 : place + 1 + count])
        place += 1 + count
    if place < len(numbers):
        raise _wrong("it holds too much", header, widths)
    return _Faces(
        _whole(np.concatenate(corners)),
        np.array(counts, dtype=np.int64),
        np.zeros((0, 3)),
        np.zeros(header.faces, dtype=bool),
    )


def _whole(numbers: FloatArray) -> IntArray:
    wrong = np.flatnonzero(~(np.abs(numbers) < 2**53) | (np.floor(numbers) != numbers))
    if len(wrong):
        raise MeshError(f"a face holds {numbers[wrong[0]]:g}; whole numbers are needed")
    return numbers.astype(np.int64)


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
    what: str, header: _Header, widths: IntArray | None, face: int | None = None
) -> MeshError:
    lines = "" if widths is None else f", and {len(widths)} lines follow"
    at = "" if face is None else f" (at face {face})"
    return MeshError(
        f"{what}: its header promises {header.vertices} vertices and {header.faces} faces{lines}{at}"
    )
