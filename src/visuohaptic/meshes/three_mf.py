"""3MF files: what they build, as parts with their colours and images."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import replace
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.limits import check_parts
from visuohaptic.meshes.parts import GREY, Paint, Part
from visuohaptic.meshes.scenes import placed
from visuohaptic.meshes.three_mf_package import NO_GROUP, Group, ModelObject, Package

_NOT_BUILT = {"support", "solidsupport", "other"}
_COLOURED = {"basematerials", "colorgroup"}


def read_3mf(data: bytes, companions: Companions) -> list[Part]:
    """Read all that a 3MF file builds, its objects where they stand.

    Parts are in the file's own frame and unit, z up (core specification, section 3). Supports, and what
    only changes other objects, are no parts of what is built. Raises `MeshError`, with the reason only,
    if the file unpacks to too much, places too many parts, or refers to what it does not hold.
    """
    companions.up_axis = "z"
    with ZipFile(io.BytesIO(data)) as archive:
        package = Package(archive)
        return list(_placed(package, companions))


def _placed(package: Package, companions: Companions) -> Iterator[Part]:
    waiting = package.model(package.start()).items[::-1]
    shown, corners = [], 0
    while waiting:
        key, matrix = waiting.pop()
        found = package.find(key)
        if found.kind in _NOT_BUILT:
            companions.notes.append(f"has an object of type {found.kind}, which is left out")
            continue
        if found.unknown:
            raise MeshError(
                f"object {key[1]!r} of {key[0]!r} has {found.unknown}, which is not read"
            )
        shown.append((key, found, matrix))
        corners += len(found.vertices) + found.faces.size
        waiting += [(one, matrix @ inner) for one, inner in reversed(found.components)]
        check_parts(
            len(shown) + len(waiting), "parts or more, counted wherever one stands", corners
        )
    for key, found, matrix in shown:
        for part in _parts(package, key[0], found, companions):
            yield from placed(part, matrix[None])


def _parts(
    package: Package, file: str, found: ModelObject, companions: Companions
) -> Iterator[Part]:
    """Return the triangles of an object: those of one colour each, and those of each image."""
    model = package.model(file)
    colours = np.tile(np.array(GREY, dtype=np.uint8), (len(found.faces), 1))
    plain = np.ones(len(found.faces), dtype=bool)
    for number in np.unique(found.groups[found.groups != NO_GROUP]):
        name, chosen = found.group_ids[number], found.groups == number
        if name not in model.groups:
            raise MeshError(f"a triangle has the property group {name[:80]!r}, which is not there")
        group = model.groups[name]
        if group.kind in _COLOURED:
            corners = _chosen(group.colours, found, chosen, name)
            # A base material covers a whole triangle.
            kept = corners if group.kind == "colorgroup" else corners[:, :1]
            colours[chosen] = np.rint(kept.mean(axis=1))
        elif group.kind == "texture2dgroup":
            paint = _paint(
                package, file, group, _chosen(group.coordinates, found, chosen, name), companions
            )
            if paint is not None:
                plain &= ~chosen
                yield _compact(found, chosen, paint)
        else:
            companions.notes.append(f"has colours of kind {group.kind}, which are not read")
    if plain.any():
        coloured = (found.groups[plain] != NO_GROUP).any()
        yield Part(found.vertices, found.faces[plain], colours[plain] if coloured else None)


def _chosen(rows: NDArray[Any], found: ModelObject, chosen: BoolArray, name: str) -> NDArray[Any]:
    properties = found.properties[chosen]
    if properties.min(initial=0) < 0 or properties.max(initial=0) >= len(rows):
        raise MeshError(
            f"a triangle has property {properties.max()} of group {name[:80]!r}; {len(rows)} are there"
        )
    return rows[properties]


def _paint(
    package: Package, file: str, group: Group, corners: FloatArray, companions: Companions
) -> Paint | None:
    images = package.model(file).images
    path, wraps = images.get(group.image, ("", (0, 0)))
    image = package.image(path)
    if image is None:
        clause = f"image {path[:80]!r}, which is not in the archive or no image that can be read"
        companions.missing.append(clause)
        return None
    return Paint(image, corners, wraps)


def _compact(found: ModelObject, chosen: BoolArray, paint: Paint) -> Part:
    named, faces = np.unique(found.faces[chosen], return_inverse=True)
    return replace(Part(found.vertices[named], faces.reshape(-1, 3)), paint=paint)
