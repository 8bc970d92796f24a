"""OBJ files: polygons with the colours and images of their materials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.limits import check_lines, check_parts
from visuohaptic.meshes.mtl_files import Material, Materials, image_name, read_libraries
from visuohaptic.meshes.obj_statements import MOST_SHOWN, ObjStatements, Polygons, read_statements
from visuohaptic.meshes.parts import GREY, Paint, Part
from visuohaptic.meshes.polygons import cuts
from visuohaptic.meshes.wavefront import as_utf_8, shown

_NO_MATERIAL = frozenset({"", "None", "(null)"})  # Blender's names of none
_AT_ONCE = 1 << 16  # faces
_LARGEST_BYTE = 255.0
_HALVES = np.array([[0, 1, 2], [2, 3, 0]], dtype=np.int32)  # of a quadrilateral
_ALMOST_ONE = 1.05  # a colour of 1 as rounding may leave it


@dataclass(frozen=True)
class _Vertices:
    """What corners name: points (v, 3), colours (v, 3), 0 to 1 or NaN, and image coordinates (t, 2)."""

    points: FloatArray
    colours: NDArray[np.float32] | None
    places: FloatArray


def read_obj(data: bytes, companions: Companions) -> list[Part]:
    """Read the polygons of an OBJ file as triangles, in one part or two per material.

    A face has its material's diffuse colour, multiplied by the mean colour of its vertices if they
    have any, and its material's image if all its corners have image coordinates. Polygons that are
    not convex are cut as `cuts` does. The parts of the material that is used first are the last.

    Raises `MeshError`, with the reason and the line, where a word is no number, a face names a vertex
    that is not there, or a statement shows a surface that is no polygon.
    """
    data = as_utf_8(data)
    check_lines(data)
    said = read_statements(data)
    del data
    check_parts(len(said.polygons), "materials")
    materials = read_libraries(said.libraries, companions)
    _note_what_is_not_read(said, materials, companions)
    vertices = _Vertices(
        np.frombuffer(said.points).reshape(-1, 3),
        _vertex_colours(said, companions),
        np.frombuffer(said.places).reshape(-1, 2),
    )
    parts = []
    while said.polygons:
        # What is said of a material is not needed beside its part.
        name, polygons = said.polygons.popitem()
        parts += _parts(polygons, materials.find(name) or Material(), vertices, companions)
    return parts if len(parts) == 1 else [_with_own_vertices(part) for part in parts]


def _note_what_is_not_read(
    said: ObjStatements, materials: Materials, companions: Companions
) -> None:
    if said.without_area:
        counts = " and ".join(f"{count} {what}" for what, count in said.without_area.items())
        companions.notes.append(f"has {counts}, which have no surface")
    if said.unknown:
        words = ", ".join(f"{word} (line {line})" for word, line in said.unknown.items())
        companions.notes.append(f"has statements that are not known: {words}")
    names = [name for name in said.polygons if name not in _NO_MATERIAL]
    missing = [name for name in names if materials.find(name) is None]
    if missing and not said.libraries:
        companions.notes.append(
            f"names materials, {_listed(missing)}, and no library of them (mtllib)"
        )
    elif missing and materials.by_name:
        companions.missing.append(
            f"materials, {_listed(missing)}, which none of its libraries holds"
        )


def _listed(names: Sequence[str]) -> str:
    more = [f"{len(names) - MOST_SHOWN} more"] if len(names) > MOST_SHOWN else []
    return ", ".join([*(shown(name.encode()) for name in names[:MOST_SHOWN]), *more])


def _vertex_colours(said: ObjStatements, companions: Companions) -> NDArray[np.float32] | None:
    """Return colours (v, 3) from 0 to 1, NaN where a vertex has none; None where no vertex has one."""
    # Some programs write colours from 0 to 1, others from 0 to 255.
    if not said.colours:
        return None
    colours = np.full((len(said.points) // 3, 3), np.nan, dtype=np.float32)
    known = np.frombuffer(said.colours, dtype=np.float32)
    colours.reshape(-1)[: len(known)] = known
    low, high = np.fmin.reduce(known), np.fmax.reduce(known)
    if low >= 0 and high <= _ALMOST_ONE:
        return np.minimum(colours, 1.0)
    whole = (known == np.rint(known)) | np.isnan(known)
    if low >= 0 and high <= _LARGEST_BYTE and (high >= 2 or whole.all()):
        return colours / np.float32(_LARGEST_BYTE)
    companions.notes.append(
        f"has numbers from {low:g} to {high:g} behind vertices' coordinates, which are no colours: "
        "0 to 1 or 0 to 255 are needed"
    )
    return None


def _parts(
    polygons: Polygons, material: Material, vertices: _Vertices, companions: Companions
) -> list[Part]:
    corners = _corners(polygons, len(vertices.points))
    triangles = _triangles(polygons, corners, vertices.points)
    faces = np.empty(triangles.shape, dtype=np.int64)
    for start in range(0, len(faces), _AT_ONCE):
        faces[start : start + _AT_ONCE] = corners[triangles[start : start + _AT_ONCE]]
    del corners
    plain = Part(vertices.points, faces, _face_colours(faces, material, vertices.colours))
    image_map = material.image_map
    if image_map is None:
        return [plain]
    image = companions.image(image_name(image_map, companions), image_map.beside)
    if image is None:
        return [plain]
    if not polygons.places:
        companions.notes.append("names images for faces that have no image coordinates (vt)")
        return [plain]
    places = _places(polygons, len(vertices.places), companions)[triangles]
    painted: BoolArray = np.all(places >= 0, axis=1)
    if not painted.any():
        return [plain]
    uv = image_map.placed(vertices.places[places[painted]])
    shown = replace(
        _some_of(plain, painted), paint=Paint(image, uv, image_map.wraps, material.tint)
    )
    return [shown] if painted.all() else [shown, _some_of(plain, ~painted)]


def _corners(polygons: Polygons, vertices: int) -> NDArray[np.int32]:
    """Return corners as rows of vertices."""
    corners = np.frombuffer(polygons.corners, np.int32)
    wrong = np.flatnonzero((corners < 1) | (corners > vertices))
    if len(wrong):
        there = f"1 to {vertices} are" if vertices else "none is"
        raise MeshError(
            f"line {_line(polygons, wrong[0])}: a face names vertex {corners[wrong[0]]}; {there} there"
        )
    return corners - 1


def _places(polygons: Polygons, places: int, companions: Companions) -> NDArray[np.int32]:
    """Return corners as rows of image coordinates, -1 where there are none."""
    corners = np.zeros(len(polygons.corners), dtype=np.int32)
    corners[: len(polygons.places)] = polygons.places
    wrong = np.flatnonzero((corners < 0) | (corners > places))
    if len(wrong):
        companions.notes.append(
            f"names image coordinates that are not there (line {_line(polygons, wrong[0])}: "
            f"{corners[wrong[0]]}; {places} are there), so that faces lack their image"
        )
    return np.where((corners < 1) | (corners > places), -1, corners - 1)


def _line(polygons: Polygons, corner: int) -> int:
    ends = np.cumsum(polygons.counts)
    return polygons.lines[int(np.searchsorted(ends, corner, side="right"))]


def _triangles(
    polygons: Polygons, corners: NDArray[np.int32], points: FloatArray
) -> NDArray[np.int32]:
    """Cut polygons into triangles (t, 3), whose numbers are rows of `corners`, polygon after polygon."""
    counts = np.frombuffer(polygons.counts, np.int32)
    if (counts == 3).all():
        return np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    cut = cuts(points, corners.astype(np.int64), counts.astype(np.int64))
    starts = np.cumsum(counts, dtype=np.int32) - counts
    if not cut and (counts == 4).all() and _of_one_form(polygons):
        # All first halves come first, as in the benchmark's surfaces since they were first made.
        return np.concatenate([starts[:, None] + half for half in _HALVES])
    sizes = counts - 2
    for polygon, triangles in cut.items():
        sizes[polygon] = len(triangles)
    of = np.repeat(np.arange(len(counts), dtype=np.int32), sizes)
    firsts = np.cumsum(sizes, dtype=np.int32) - sizes
    second = np.arange(1, len(of) + 1, dtype=np.int32) - firsts[of]
    fans = np.column_stack([np.zeros_like(second), second, second + 1])
    fans[(counts[of] == 4) & (second == 2)] = _HALVES[1]
    for polygon, triangles in cut.items():
        fans[firsts[polygon] : firsts[polygon] + len(triangles)] = triangles
    fans += starts[of, None]
    return fans


def _of_one_form(polygons: Polygons) -> bool:
    """Tell whether all corners have image coordinates, or none."""
    places = np.frombuffer(polygons.places, np.int32)
    return not len(places) or (len(places) == len(polygons.corners) and bool(places.all()))


def _face_colours(
    faces: IntArray, material: Material, colours: NDArray[np.float32] | None
) -> NDArray[np.uint8] | None:
    """Return colours (f, 3), sRGB, of the material and, where they have any, of the vertices."""
    if material.diffuse is None and colours is None:
        return None
    own = np.array(GREY) if material.diffuse is None else 255.0 * np.array(material.diffuse)
    whole = np.tile(np.rint(own).astype(np.uint8), (len(faces), 1))
    if colours is None:
        return whole
    for start in range(0, len(faces), _AT_ONCE):
        first, second, third = faces[start : start + _AT_ONCE].T
        mean = (colours[first] + colours[second] + colours[third]) / 3
        known = ~np.isnan(mean).any(axis=1)
        whole[start : start + _AT_ONCE][known] = np.rint(255.0 * mean[known] * material.tint)
    return whole


def _some_of(part: Part, faces: BoolArray) -> Part:
    colours = None if part.colours is None else part.colours[faces]
    return Part(part.vertices, part.faces[faces], colours)


def _with_own_vertices(part: Part) -> Part:
    """Return a part without the vertices of other parts, which are many times as many if parts are."""
    named, faces = np.unique(part.faces, return_inverse=True)
    return replace(part, vertices=part.vertices[named], faces=faces.reshape(-1, 3))
