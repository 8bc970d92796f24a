"""Read the build items of a 3MF file as parts with colours and images."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import replace
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.archives import count_members
from meshreaders.base.arrays import BoolArray, FloatArray
from meshreaders.base.errors import MeshError
from meshreaders.companions import Companions
from meshreaders.formats.limits import check_parts
from meshreaders.formats.scenes import placed
from meshreaders.formats.three_mf_package import MOST_MEMBERS, NO_GROUP, Group, ModelObject, Package
from meshreaders.parts import GREY, Paint, Part

_NOT_BUILT = {"support", "solidsupport", "other"}
_COLOURED = {"basematerials", "colorgroup"}


def read_3mf(data: bytes, companions: Companions) -> list[Part]:
    """Read the objects of all build items of a 3MF file, with their transforms.

    Parts are in the frame and unit of the file, z up (core specification, section 3). Supports and modifier objects are
    skipped. Raises `MeshError` with the reason if the file unpacks to too many bytes, places too many parts, or
    refers to a missing object.
    """
    companions.up_axis = "z"
    members = count_members(data)
    if members > MOST_MEMBERS:
        raise MeshError(f"it holds {members} files; {MOST_MEMBERS} are allowed")
    with ZipFile(io.BytesIO(data)) as archive:
        package = Package(archive)
        return list(_placed_parts(package, companions))


def _placed_parts(package: Package, companions: Companions) -> Iterator[Part]:
    stack = package.model(package.start()).items[::-1]
    placements, corners = [], 0
    while stack:
        key, matrix = stack.pop()
        model_object = package.find(key)
        if model_object.kind in _NOT_BUILT:
            companions.notes.append(f"has an object of type {model_object.kind}, which is left out")
            continue
        if model_object.unknown:
            raise MeshError(
                f"object {key[1]!r} of {key[0]!r} has {model_object.unknown}, which is not read"
            )
        if model_object.passed_over:
            companions.notes.append(
                f"has {model_object.passed_over} (object {key[1]!r} of {key[0]!r}), which is not read"
            )
        placements.append((key, model_object, matrix))
        corners += len(model_object.vertices) + model_object.faces.size
        stack += [
            (component, matrix @ component_matrix)
            for component, component_matrix in reversed(model_object.components)
        ]
        check_parts(
            len(placements) + len(stack), "parts or more, each counted per instance", corners
        )
    for key, model_object, matrix in placements:
        for part in _parts(package, key[0], model_object, companions):
            yield from placed(part, matrix[None])


def _parts(
    package: Package, file: str, model_object: ModelObject, companions: Companions
) -> Iterator[Part]:
    """Yield the triangles of an object: one part per image, and one part for all other triangles."""
    model = package.model(file)
    colours = np.tile(np.array(GREY, dtype=np.uint8), (len(model_object.faces), 1))
    without_image = np.ones(len(model_object.faces), dtype=bool)
    for number in np.unique(model_object.groups[model_object.groups != NO_GROUP]):
        name, in_group = model_object.group_ids[number], model_object.groups == number
        if name not in model.groups:
            raise MeshError(f"a triangle has the property group {name[:80]!r}, which is not there")
        group = model.groups[name]
        if group.kind in _COLOURED:
            corners = _corner_properties(group.colours, model_object, in_group, name)
            # A base material colours whole triangles, so the first corner decides.
            averaged = corners if group.kind == "colorgroup" else corners[:, :1]
            colours[in_group] = np.rint(averaged.mean(axis=1))
        elif group.kind == "texture2dgroup":
            paint = _paint(
                package,
                file,
                group,
                _corner_properties(group.coordinates, model_object, in_group, name),
                companions,
            )
            if paint is not None:
                without_image &= ~in_group
                yield _part_with_image(model_object, in_group, paint)
        else:
            companions.notes.append(f"has colours of kind {group.kind}, which are not read")
    if without_image.any():
        coloured = (model_object.groups[without_image] != NO_GROUP).any()
        yield Part(
            model_object.vertices,
            model_object.faces[without_image],
            colours[without_image] if coloured else None,
        )


def _corner_properties(
    rows: NDArray[Any], model_object: ModelObject, in_group: BoolArray, name: str
) -> NDArray[Any]:
    properties = model_object.properties[in_group]
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


def _part_with_image(model_object: ModelObject, in_group: BoolArray, paint: Paint) -> Part:
    used, faces = np.unique(model_object.faces[in_group], return_inverse=True)
    return replace(Part(model_object.vertices[used], faces.reshape(-1, 3)), paint=paint)
