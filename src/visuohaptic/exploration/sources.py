"""Sources of an object: a file, an open file, a mesh in memory, or arrays."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from meshreaders.reading import name_of
from visuohaptic.base.errors import ParameterError
from visuohaptic.meshes.catalogue import Model, read_catalogue
from visuohaptic.meshes.model_files import PACKED, Source
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.up_axis import AXES, are_perpendicular
from visuohaptic.parameters import ExperimentParameters, as_parameters

UNKNOWN_CLASS = "unknown"

UP_ADVICE = 'load the mesh with up="z"'
"""End of the note on a doubtful up axis."""


def model_of(source: Source) -> Model:
    """Return the catalogue's model of a packed model, and for other sources a model with only a name."""
    if not isinstance(source, str | Path):
        return Model(UNKNOWN_CLASS, name_of(source))
    path = Path(source)
    stem = path.name.removesuffix(".gz").rpartition(".")[0] or path.name
    # A file's name may have bytes that are not UTF-8, and tables hold only text.
    named = Model(UNKNOWN_CLASS, stem.encode("utf-8", "replace").decode("utf-8"))
    return _catalogued(path) or named


def with_axes(
    parameters: MeshParameters, source: Source, up: str | None, front: str | None
) -> MeshParameters:
    """Return the parameters with arguments `up` and `front` of `load`. Raises `ParameterError` if they are not allowed."""
    if up is None and front is None:
        return parameters
    name = name_of(source)
    if name.endswith(PACKED):
        raise ParameterError(
            f"{name} is a packed model, which has y up and its front at z; up and front are for other files."
        )
    own_front = front or parameters.own_front_axis
    for argument, axis, allowed in (
        ("up", up, ("file", "auto", *AXES)),
        ("front", front, AXES),
    ):
        if axis is not None and axis not in allowed:
            raise ParameterError(f"{argument} is {axis!r}; {', '.join(allowed)} are allowed.")
    own_up = up or parameters.own_up_axis
    if own_front and own_up in AXES and not are_perpendicular(own_up, own_front):
        raise ParameterError(
            f"up is {own_up} and front is {own_front}; perpendicular axes are needed."
        )
    return parameters.model_copy(update={"own_up_axis": own_up, "own_front_axis": own_front})


def is_one_source(value: Any) -> bool:
    """Return whether `value` is the source of one object, not a collection of sources."""
    pair = isinstance(value, tuple) and len(value) == 2
    # Two arrays are one object; two paths, meshes or open files are two.
    if pair and not any(_is_whole(part) for part in value):
        return True
    return isinstance(value, str | Path) or _is_whole(value)


def mesh_parameters(
    values: MeshParameters | ExperimentParameters | Mapping[str, Any] | None,
) -> MeshParameters:
    """Return section `meshes` of parameters, of a mapping of all sections, or of a mapping of the section's names."""
    if isinstance(values, MeshParameters):
        return values
    if isinstance(values, Mapping) and values and set(values) <= set(MeshParameters.model_fields):
        values = {"meshes": values}
    return as_parameters(values).meshes


def _is_whole(value: Any) -> bool:
    return isinstance(value, str | Path) or any(
        hasattr(value, name)
        for name in ("vertices", "vertex", "points", "geometry", "read", "surface")
    )


def _catalogued(path: Path) -> Model | None:
    """Find a packed model, `<folder>/<set>/<class>/<name>.ply.gz`, in `<folder>/catalogue.csv`."""
    folders = path.absolute().parents
    if not path.name.endswith(PACKED) or len(folders) < 3:
        return None
    catalogue = folders[2] / "catalogue.csv"
    if not catalogue.is_file():
        return None
    key = f"{folders[0].name}/{path.name.removesuffix(PACKED)}"
    return next((model for model in read_catalogue(catalogue) if model.key == key), None)
