"""Sources of an object: a file, an open file, a mesh in memory, or arrays."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.catalogue import Model, read_catalogue
from visuohaptic.meshes.model_files import PACKED, Source, name_of
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import prepare_with_matrix
from visuohaptic.parameters import ExperimentParameters, as_parameters

UNKNOWN_CLASS = "unknown"


def read_source(
    source: Source, file_type: str | None, parameters: MeshParameters
) -> tuple[str, Surface, FloatArray]:
    """Return an object's key, its surface in the object frame, and the matrix (4, 4) from its file's frame.

    `file_type` is the format of an open file, such as ``obj``. Raises `MeshError` if `source` is no source of an
    object, can't be read, or has no surface.
    """
    model = _model_of(source)
    return model.key, *prepare_with_matrix(model, source, parameters, file_type)


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
        hasattr(value, name) for name in ("vertices", "vertex", "geometry", "read", "surface")
    )


def _model_of(source: Source) -> Model:
    if not isinstance(source, str | Path):
        return Model(UNKNOWN_CLASS, name_of(source))
    path = Path(source)
    stem = path.name.removesuffix(".gz").rpartition(".")[0] or path.name
    # A file's name may have bytes that are not UTF-8, and tables hold only text.
    named = Model(UNKNOWN_CLASS, stem.encode("utf-8", "replace").decode("utf-8"))
    return _catalogued(path) or named


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
