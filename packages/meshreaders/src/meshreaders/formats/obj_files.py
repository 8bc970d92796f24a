"""Read OBJ files: polygons with colours and images of materials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import BoolArray, FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.companions import Companions
from meshreaders.formats.limits import check_lines, check_parts
from meshreaders.formats.mtl_files import Material, Materials, image_name, read_libraries
from meshreaders.formats.obj_statements import MOST_SHOWN, ObjStatements, Polygons, read_statements
from meshreaders.formats.wavefront import as_utf_8, quoted
from meshreaders.parts import GREY, Paint, Part
from meshreaders.polygons import cuts

_NO_MATERIAL = frozenset({"", "None", "(null)"})  # names that Blender writes for no material
_BLOCK_FACES = 1 << 16
_LARGEST_BYTE = 255.0
_HALVES = np.array([[0, 1, 2], [2, 3, 0]], dtype=np.int32)  # triangles of a quadrilateral
_ALMOST_ONE = 1.05  # largest colour that counts as 1 with rounding


@dataclass(frozen=True)
class _Vertices:
    """Points (v, 3), their colours (v, 3), 0 to 1 or NaN, and image coordinates (t, 2)."""

    points: FloatArray
    colours: NDArray[np.float32] | None
    coordinates: FloatArray


def read_obj(data: bytes, companions: Companions) -> list[Part]:
    """Read the polygons of an OBJ file as triangles, in one or two parts per material.

    The colour of a face is the diffuse colour of its material, multiplied by the mean colour of its vertices if they
    have colours. A face has the image of its material if all its corners have image coordinates. Polygons are cut
    into triangles with `cuts`. Materials come in reverse order of their first use.

    Raises `MeshError`, with line and reason, if a word is no number, a face names a missing vertex, or a statement
    describes a surface that is no polygon.
    """
    data = as_utf_8(data)
    check_lines(data)
    statements = read_statements(data)
    del data
    check_parts(len(statements.polygons), "materials")
    materials = read_libraries(statements.libraries, companions)
    _note_unread(statements, materials, companions)
    vertices = _Vertices(
        np.frombuffer(statements.points).reshape(-1, 3),
        _vertex_colours(statements, companions),
        np.frombuffer(statements.coordinates).reshape(-1, 2),
    )
    parts = []
    while statements.polygons:
        # `popitem` frees the polygons of a material after they became a part.
        name, polygons = statements.polygons.popitem()
        parts += _parts(polygons, materials.find(name) or Material(), vertices, companions)
    return parts if len(parts) == 1 else [_without_other_vertices(part) for part in parts]


def _note_unread(statements: ObjStatements, materials: Materials, companions: Companions) -> None:
    if statements.without_area:
        counts = " and ".join(f"{count} {kind}" for kind, count in statements.without_area.items())
        companions.notes.append(f"has {counts}, which have no surface")
    if statements.unknown:
        words = ", ".join(f"{word} (line {line})" for word, line in statements.unknown.items())
        companions.notes.append(f"has statements that are not known: {words}")
    names = [name for name in statements.polygons if name not in _NO_MATERIAL]
    missing = [name for name in names if materials.find(name) is None]
    if missing and not statements.libraries:
        companions.notes.append(
            f"names materials, {_listed(missing)}, and no library of them (mtllib)"
        )
    elif missing and materials.libraries:
        companions.missing.append(
            f"materials, {_listed(missing)}, which are in none of its libraries"
        )


def _listed(names: Sequence[str]) -> str:
    more = [f"{len(names) - MOST_SHOWN} more"] if len(names) > MOST_SHOWN else []
    return ", ".join([*(quoted(name.encode()) for name in names[:MOST_SHOWN]), *more])


def _vertex_colours(
    statements: ObjStatements, companions: Companions
) -> NDArray[np.float32] | None:
    """Return colours (v, 3) from 0 to 1, NaN for a vertex without colour; None without colours."""
    # Some programs write colours from 0 to 1, others from 0 to 255.
    if not statements.colours:
        return None
    colours = np.full((len(statements.points) // 3, 3), np.nan, dtype=np.float32)
    given = np.frombuffer(statements.colours, dtype=np.float32)
    # Of seven numbers, the fourth is the weight (appendix B1: `v x y z w`) if it is the default weight 1 at all
    # vertices; otherwise the seventh is alpha.
    sevenths = np.frombuffer(statements.sevenths, dtype=np.float32)
    has_seven = np.flatnonzero(~np.isnan(sevenths))
    if len(has_seven) and (given.reshape(-1, 3)[has_seven, 0] == 1).all():
        given = given.copy()
        rows = given.reshape(-1, 3)
        rows[has_seven] = np.column_stack([rows[has_seven, 1:], sevenths[has_seven]])
    colours.reshape(-1)[: len(given)] = given
    low, high = np.fmin.reduce(given), np.fmax.reduce(given)
    if low >= 0 and high <= _ALMOST_ONE:
        return np.minimum(colours, 1.0)
    is_whole = (given == np.rint(given)) | np.isnan(given)
    if low >= 0 and high <= _LARGEST_BYTE and (high >= 2 or is_whole.all()):
        return colours / np.float32(_LARGEST_BYTE)
    companions.notes.append(
        f"has numbers from {low:g} to {high:g} after coordinates of vertices, which are no colours: "
        "0 to 1 or 0 to 255 are needed"
    )
    return None


def _parts(
    polygons: Polygons, material: Material, vertices: _Vertices, companions: Companions
) -> list[Part]:
    corners = _corners(polygons, len(vertices.points))
    triangles = _triangles(polygons, corners, vertices.points, keep_corners=companions.keep_corners)
    faces = np.empty(triangles.shape, dtype=np.int64)
    for start in range(0, len(faces), _BLOCK_FACES):
        faces[start : start + _BLOCK_FACES] = corners[triangles[start : start + _BLOCK_FACES]]
    del corners
    without_image = Part(vertices.points, faces, _face_colours(faces, material, vertices.colours))
    image_map = material.image_map
    if image_map is None:
        return [without_image]
    image = companions.image(image_name(image_map, companions), image_map.beside)
    if image is None:
        return [without_image]
    if not polygons.coordinates:
        companions.notes.append("names images for faces that have no image coordinates (vt)")
        return [without_image]
    coordinates = _coordinate_rows(polygons, len(vertices.coordinates), companions)[triangles]
    painted: BoolArray = np.all(coordinates >= 0, axis=1)
    if not painted.any():
        return [without_image]
    uv = image_map.placed(vertices.coordinates[coordinates[painted]])
    with_image = replace(
        _subset(without_image, painted), paint=Paint(image, uv, image_map.wraps, material.tint)
    )
    return [with_image] if painted.all() else [with_image, _subset(without_image, ~painted)]


def _corners(polygons: Polygons, vertices: int) -> NDArray[np.int32]:
    """Return the row of the vertex of each corner."""
    corners = np.frombuffer(polygons.corners, np.int32)
    wrong = np.flatnonzero((corners < 1) | (corners > vertices))
    if len(wrong):
        allowed = f"1 to {vertices} are" if vertices else "none is"
        raise MeshError(
            f"line {_line(polygons, wrong[0])}: a face names vertex {corners[wrong[0]]}; {allowed} there"
        )
    return corners - 1


def _coordinate_rows(polygons: Polygons, count: int, companions: Companions) -> NDArray[np.int32]:
    """Return the row of image coordinates of each corner; -1 for a corner without."""
    corners = np.zeros(len(polygons.corners), dtype=np.int32)
    corners[: len(polygons.coordinates)] = polygons.coordinates
    wrong = np.flatnonzero((corners < 0) | (corners > count))
    if len(wrong):
        companions.notes.append(
            f"names image coordinates that are not there (line {_line(polygons, wrong[0])}: "
            f"{corners[wrong[0]]}; {count} are there), so that faces lack their image"
        )
    return np.where((corners < 1) | (corners > count), -1, corners - 1)


def _line(polygons: Polygons, corner: int) -> int:
    ends = np.cumsum(polygons.counts)
    return polygons.lines[int(np.searchsorted(ends, corner, side="right"))]


def _triangles(
    polygons: Polygons, corners: NDArray[np.int32], points: FloatArray, *, keep_corners: bool
) -> NDArray[np.int32]:
    """Cut polygons into triangles (t, 3) as rows of `corners`, polygon after polygon."""
    counts = np.frombuffer(polygons.counts, np.int32)
    if (counts == 3).all():
        return np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    triangles_of = cuts(
        points, corners.astype(np.int64), counts.astype(np.int64), keep_corners=keep_corners
    )
    starts = np.cumsum(counts, dtype=np.int32) - counts
    if not triangles_of and (counts == 4).all() and _all_or_none_have_coordinates(polygons):
        # All first halves come first: the surfaces of the benchmark keep this order of faces.
        return np.concatenate([starts[:, None] + half for half in _HALVES])
    pieces = counts - 2
    for polygon, triangles in triangles_of.items():
        pieces[polygon] = len(triangles)
    owners = np.repeat(np.arange(len(counts), dtype=np.int32), pieces)
    begins = np.cumsum(pieces, dtype=np.int32) - pieces
    second = np.arange(1, len(owners) + 1, dtype=np.int32) - begins[owners]
    fans = np.column_stack([np.zeros_like(second), second, second + 1])
    fans[(counts[owners] == 4) & (second == 2)] = _HALVES[1]
    for polygon, triangles in triangles_of.items():
        fans[begins[polygon] : begins[polygon] + len(triangles)] = triangles
    fans += starts[owners, None]
    return fans


def _all_or_none_have_coordinates(polygons: Polygons) -> bool:
    """Return whether all corners have image coordinates, or no corner has."""
    coordinates = np.frombuffer(polygons.coordinates, np.int32)
    return not len(coordinates) or (
        len(coordinates) == len(polygons.corners) and bool(coordinates.all())
    )


def _face_colours(
    faces: IntArray, material: Material, colours: NDArray[np.float32] | None
) -> NDArray[np.uint8] | None:
    """Return colours (f, 3), sRGB, of the material, multiplied by vertex colours if there are any."""
    if material.diffuse is None and colours is None:
        return None
    colour = np.array(GREY) if material.diffuse is None else 255.0 * np.array(material.diffuse)
    face_colours = np.tile(np.rint(colour).astype(np.uint8), (len(faces), 1))
    if colours is None:
        return face_colours
    for start in range(0, len(faces), _BLOCK_FACES):
        first, second, third = faces[start : start + _BLOCK_FACES].T
        mean = (colours[first] + colours[second] + colours[third]) / 3
        coloured = ~np.isnan(mean).any(axis=1)
        face_colours[start : start + _BLOCK_FACES][coloured] = np.rint(
            255.0 * mean[coloured] * material.tint
        )
    return face_colours


def _subset(part: Part, faces: BoolArray) -> Part:
    colours = None if part.colours is None else part.colours[faces]
    return Part(part.vertices, part.faces[faces], colours)


def _without_other_vertices(part: Part) -> Part:
    """Return a part without the vertices of other parts."""
    used, faces = np.unique(part.faces, return_inverse=True)
    return replace(part, vertices=part.vertices[used], faces=faces.reshape(-1, 3))
