"""Read OFF files (Object File Format of Geomview) with colours of vertices and faces."""

from __future__ import annotations

import re
from array import array
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.colours import as_bytes, mean_of_corners
from meshreaders.companions import Companions
from meshreaders.formats.limits import check_lines
from meshreaders.formats.text_numbers import (
    blocks_of_lines,
    blocks_of_words,
    numbers_by_line,
    plain_lines,
)
from meshreaders.parts import GREY, Part
from meshreaders.polygons import check_corners, index_runs, triangulate_points

# Files of ModelNet have no blank between keyword and counts.
_KEYWORD = re.compile(rb"\s*(ST)?(C?N?|NC)(4?)OFF(?=[\s\d]|$)", re.IGNORECASE)
# Two or three counts on a line, or three with any white space between them.
_COUNTS = re.compile(
    rb"\s*(?:(\d+)[ \t]+(\d+)(?:[ \t]+\d+)?[ \t]*(?:\n|$)|(\d+)\s+(\d+)\s+\d+(?=\s|$))"
)
_COMMENT = re.compile(rb"#[^\n]*")
_BLOCK_FACES = 1 << 14


@dataclass(frozen=True)
class _Header:
    """A header of `length` bytes: numbers of vertices and faces, and whether vertices have image coordinates, colours and normals."""

    texture: bool
    colours: bool
    normals: bool
    vertices: int
    faces: int
    length: int


@dataclass(frozen=True)
class _Faces:
    """Corners of all faces (n,), corners per face (f,), whether a face is coloured (f,), and colours of coloured faces (c, 3)."""

    corners: IntArray
    counts: IntArray
    colours: FloatArray
    coloured: NDArray[np.bool_]


def read_off(data: bytes, companions: Companions) -> list[Part]:
    """Read an OFF file as one part, polygons cut into triangles.

    Any white space separates numbers, but colours of faces need one line per face. Colours go to 255, or to 1 if no
    number is above 1.

    Raises `MeshError` with the reason if the numbers of rows differ from the header, a word is no number, a face
    names a missing vertex, or the file is binary.
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
        # Free the text: the numbers need its memory.
        del text
        blocks = _divide_numbers(header, numbers, widths)
        del numbers, widths
    else:
        del text
    rows, faces = _join_blocks(*blocks)
    points = np.ascontiguousarray(rows[:, :3])
    check_corners(faces.corners, len(points))
    triangles, pieces = triangulate_points(points, faces.corners, faces.counts)
    if header.texture:
        companions.notes.append("has image coordinates, but OFF can't name an image")
    return [
        Part(points, triangles, _colours(faces, pieces, _vertex_colours(header, rows), triangles))
    ]


def _read_header(text: bytes) -> _Header:
    keyword = _KEYWORD.match(text)
    start = keyword.end() if keyword else 0
    if text[start:].lstrip(b" \t").startswith(b"BINARY"):
        raise MeshError("it is binary OFF, which is not read; export it as text")
    counts = _COUNTS.match(text, start)
    if keyword is None and counts is None:
        raise MeshError("its first line is not OFF, COFF or NOFF")
    if counts is None:
        raise MeshError("its header does not have the numbers of vertices and faces")
    texture, extras, dimensions = keyword.groups() if keyword else (None, b"", b"")
    if dimensions:
        raise MeshError("it has vertices of 4 dimensions; 3 are needed")
    vertices, faces = (int(count) for count in counts.groups() if count is not None)
    return _Header(
        texture is not None,
        b"C" in extras.upper(),
        b"N" in extras.upper(),
        vertices,
        faces,
        counts.end(),
    )


def _read_by_lines(header: _Header, text: bytes) -> tuple[list[FloatArray], list[_Faces]] | None:
    """Read vertices and faces in blocks; None unless each row has its own line."""
    if text.count(b"\n", header.length) + 1 < header.vertices + header.faces:
        return None
    line = 1 + text.count(b"\n", 0, header.length)
    rows: list[FloatArray] = []
    faces: list[_Faces] = []
    vertices_left, faces_read = header.vertices, 0
    for block in blocks_of_lines(text, header.length):
        numbers, widths = numbers_by_line(block, line)
        widths = widths[widths > 0]
        line += block.count(b"\n")
        if vertices_left and len(widths):
            columns = rows[0].shape[1] if rows else int(widths[0])
            vertices_here = min(vertices_left, len(widths))
            if columns < 3 or (widths[:vertices_here] != columns).any():
                return None
            rows.append(numbers[: vertices_here * columns].reshape(-1, columns))
            numbers, widths = numbers[vertices_here * columns :], widths[vertices_here:]
            vertices_left -= vertices_here
        if faces_read + len(widths) > header.faces:
            return None
        try:
            faces.append(_faces_of_rows(numbers, widths, faces_read))
        except MeshError:
            # A face may have several lines. In a broken file, `_divide_numbers` raises the error.
            return None
        faces_read += len(widths)
    if vertices_left or faces_read < header.faces or not rows:
        return None
    return rows, faces


def _join_blocks(rows: list[FloatArray], faces: list[_Faces]) -> tuple[FloatArray, _Faces]:
    points = np.concatenate(rows)
    # Free the blocks, which are joined now.
    rows.clear()
    return points, _Faces(
        np.concatenate([block.corners for block in faces]),
        np.concatenate([block.counts for block in faces]),
        np.concatenate([block.colours for block in faces]),
        np.concatenate([block.coloured for block in faces]),
    )


def _read_numbers(header: _Header, text: bytes) -> tuple[FloatArray, NDArray[np.int32]]:
    """Return all numbers (n,) after the header, and the number of numbers per non-empty line."""
    numbers, widths = bytearray(), bytearray()
    line, open_width = 1 + text.count(b"\n", 0, header.length), 0
    for block in blocks_of_words(text, header.length):
        block_numbers, line_widths = numbers_by_line(block, line)
        numbers += block_numbers.tobytes()
        line += block.count(b"\n")
        line_widths[0] += open_width
        open_width = 0
        if not block.endswith(b"\n"):
            open_width, line_widths = int(line_widths[-1]), line_widths[:-1]
        widths += line_widths[line_widths > 0].astype(np.int32).tobytes()
    widths += np.array([open_width] if open_width else [], dtype=np.int32).tobytes()
    return np.frombuffer(numbers), np.frombuffer(widths, np.int32)


def _divide_numbers(
    header: _Header, numbers: FloatArray, widths: NDArray[np.int32]
) -> tuple[list[FloatArray], list[_Faces]]:
    """Divide all numbers of a file into rows of vertices and blocks of faces."""
    columns = _columns(header, widths)
    if header.vertices * columns > len(numbers):
        raise _size_error("it is truncated", header, widths)
    rows = numbers[: header.vertices * columns].reshape(-1, columns)
    of_faces, lines = numbers[rows.size :], _lines_after(widths, rows.size)
    if lines is None or len(lines) != header.faces:
        lines = _widths_by_counts(header, of_faces, lines)
    blocks, end = [_no_faces()], 0
    for first in range(0, len(lines), _BLOCK_FACES):
        block_widths = lines[first : first + _BLOCK_FACES].astype(np.int64)
        start, end = end, end + int(block_widths.sum())
        blocks.append(_faces_of_rows(of_faces[start:end], block_widths, first))
    # Copy: a view would keep the numbers of faces in memory.
    return [rows.copy()], blocks


def _columns(header: _Header, widths: NDArray[np.int32]) -> int:
    """Return the numbers per vertex: the width of the lines if all vertices have equal lines, else by the keyword."""
    of_vertices = widths[: header.vertices]
    lines = len(widths) >= header.vertices + header.faces
    if len(of_vertices) and lines and (of_vertices == of_vertices[0]).all() and of_vertices[0] >= 3:
        return int(of_vertices[0])
    return 3 + 3 * header.normals + 4 * header.colours + 2 * header.texture


def _lines_after(widths: NDArray[np.int32], count: int) -> NDArray[np.int32] | None:
    """Return the widths of the lines after the first `count` numbers; None if a line crosses that limit."""
    ends = np.cumsum(widths, dtype=np.int64)
    lines = int(np.searchsorted(ends, count, side="right"))
    ends_with_line = count == 0 or (lines > 0 and ends[lines - 1] == count)
    return widths[lines:] if ends_with_line else None


def _widths_by_counts(
    header: _Header, numbers: FloatArray, lines: NDArray[np.int32] | None
) -> NDArray[np.int32]:
    """Return the numbers (f,) per face from its count of corners; such faces have no colours."""
    widths, position = array("i"), 0
    for face in range(header.faces):
        count = numbers.item(position) if position < len(numbers) else np.inf
        end = position + 1 + count
        if count < 0 or end > len(numbers):
            raise _size_error("it is truncated", header, lines, face)
        if not count.is_integer():
            raise MeshError(f"a face holds {count:g}; whole numbers are needed")
        widths.append(1 + int(count))
        position = int(end)
    if position < len(numbers):
        raise _size_error("it holds too much", header, lines)
    return np.frombuffer(widths, np.int32)


def _no_faces() -> _Faces:
    none = np.empty(0, np.int64)
    return _Faces(none, none, np.empty((0, 3)), np.empty(0, bool))


def _faces_of_rows(numbers: FloatArray, widths: IntArray, first: int) -> _Faces:
    """Read faces from rows of `widths` (f,) numbers: a count, corners, and optionally a colour."""
    starts = np.cumsum(widths) - widths
    counts = _integers(numbers[starts])
    wrong = np.flatnonzero((counts < 0) | (counts >= widths))
    if len(wrong):
        face = wrong[0]
        raise MeshError(
            f"face {first + face} promises {counts[face]} corners, and {widths[face] - 1} numbers follow"
        )
    corners = _integers(numbers[index_runs(starts + 1, counts)])
    # A single number is an index into a colour table of Geomview.
    coloured = widths - 1 - counts >= 3
    colour_starts = (starts + 1 + counts)[coloured]
    return _Faces(corners, counts, numbers[colour_starts[:, None] + np.arange(3)], coloured)


def _integers(numbers: FloatArray) -> IntArray:
    wrong = np.flatnonzero(~(np.abs(numbers) < 2**53) | (np.floor(numbers) != numbers))
    if len(wrong):
        raise MeshError(f"a face holds {numbers[wrong[0]]:g}; whole numbers are needed")
    return numbers.astype(np.int64)


def _colours(
    faces: _Faces,
    pieces: NDArray[np.int32],
    of_vertices: NDArray[np.uint8] | None,
    triangles: IntArray,
) -> NDArray[np.uint8] | None:
    """Return the colours (t, 3) of triangles: of the face, else mean of the vertices, else grey; None without colours."""
    colours = mean_of_corners(of_vertices, triangles)
    if not faces.coloured.any():
        return colours
    of_faces = np.zeros((len(faces.counts), 3), np.uint8)
    of_faces[faces.coloured] = as_bytes(faces.colours)
    uncoloured = np.array(GREY, np.uint8) if colours is None else colours
    coloured = np.repeat(faces.coloured, pieces)[:, None]
    return np.where(coloured, np.repeat(of_faces, pieces, axis=0), uncoloured)


def _vertex_colours(header: _Header, rows: FloatArray) -> NDArray[np.uint8] | None:
    """Return the colours (v, 3), the numbers between normals and image coordinates; None without colours."""
    start, end = 3 + 3 * header.normals, rows.shape[1] - 2 * header.texture
    extras = rows[:, start:end]
    if extras.shape[1] not in {3, 4}:
        return None
    # Without C in the keyword, these numbers may be normals.
    if not header.colours and (
        header.normals or not (extras >= 0).all() or (extras[:, :3] != np.rint(extras[:, :3])).any()
    ):
        return None
    return as_bytes(extras[:, :3])


def _size_error(
    problem: str, header: _Header, widths: NDArray[np.int32] | None, face: int | None = None
) -> MeshError:
    lines = "" if widths is None else f", and {len(widths)} lines follow"
    face_label = "" if face is None else f" (at face {face})"
    return MeshError(
        f"{problem}: its header promises {header.vertices} vertices and {header.faces} faces{lines}{face_label}"
    )
