"""What an object may come from: a file, an open file, a mesh in memory, or arrays."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias

from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.catalogue import MODEL_SUFFIXES, Model, read_catalogue
from visuohaptic.meshes.in_memory import surface_of_arrays, surface_of_trimesh
from visuohaptic.meshes.model_files import read_open_file
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import place_object, place_surface
from visuohaptic.parameters import ExperimentParameters, as_parameters

if TYPE_CHECKING:
    from trimesh import Scene, Trimesh

    Source: TypeAlias = str | Path | Trimesh | Scene | tuple[ArrayLike, ArrayLike] | BinaryIO

UNKNOWN_CLASS = "unknown"
UNNAMED = "object"
"""Name of an object whose source has none."""

_ALLOWED = "a path, a trimesh.Trimesh or Scene, (vertices, faces) or an open binary file is needed"


def read_source(
    source: Source, file_type: str | None, parameters: MeshParameters
) -> tuple[str, Surface, FloatArray]:
    """Read an object from wherever it is: its key, its surface made ready, and the way from its file's frame.

    `file_type` is the format of an open file, such as ``obj``. Raises `MeshError` if it is no source, can't
    be read, or has nothing to touch.
    """
    if isinstance(source, str | Path):
        model = _model_of(Path(source))
        return model.key, *place_object(model, source, parameters)
    surface: Surface | None
    if hasattr(source, "read"):
        name, surface = _read_open(source, file_type, parameters)
    else:
        name, surface = UNNAMED, surface_in_memory(source, UNNAMED)
    if surface is None:
        raise MeshError(f"The object is of type {type(source).__name__}; {_ALLOWED}.")
    return f"{UNKNOWN_CLASS}/{name}", *place_surface(surface, name, parameters)


def surface_in_memory(source: Any, name: str) -> Surface | None:
    """Give the surface of a mesh or scene of trimesh, or of two arrays; None of anything else."""
    if isinstance(source, tuple) and len(source) == 2:
        return surface_of_arrays(source[0], source[1], name)
    if hasattr(source, "vertices") or hasattr(source, "geometry"):
        return surface_of_trimesh(source, name)
    return None


def is_one_source(value: Any) -> bool:
    """Tell one object's source from several."""
    pair = isinstance(value, tuple) and len(value) == 2
    # Two arrays are one object; two paths, meshes or open files are two.
    if pair and not any(_is_whole(part) for part in value):
        return True
    return isinstance(value, str | Path) or _is_whole(value)


def mesh_parameters(
    values: MeshParameters | ExperimentParameters | Mapping[str, Any] | None,
) -> MeshParameters:
    """Take section `meshes` from whichever parameters are given, or from a mapping of its own names."""
    if isinstance(values, MeshParameters):
        return values
    if isinstance(values, Mapping) and values and set(values) <= set(MeshParameters.model_fields):
        values = {"meshes": values}
    return as_parameters(values).meshes


def _is_whole(value: Any) -> bool:
    return isinstance(value, str | Path) or any(
        hasattr(value, name) for name in ("vertices", "geometry", "read", "surface")
    )


def _read_open(
    stream: Any, file_type: str | None, parameters: MeshParameters
) -> tuple[str, Surface]:
    path = Path(stream.name) if isinstance(getattr(stream, "name", None), str) else Path()
    kind = file_type if file_type is not None else path.suffix.lower().removeprefix(".")
    allowed = ", ".join(suffix.removeprefix(".") for suffix in MODEL_SUFFIXES)
    if not kind:
        raise MeshError(
            f"The open file has no name; its file_type is needed; {allowed} are allowed."
        )
    if f".{kind.lower()}" not in MODEL_SUFFIXES:
        raise MeshError(f"The open file's file_type is {kind!r}; {allowed} are allowed.")
    name = _text(path.stem) or UNNAMED
    return name, read_open_file(stream, name, f".{kind}", parameters.largest_megabytes)


def _model_of(path: Path) -> Model:
    return _catalogued(path) or Model(
        UNKNOWN_CLASS, _text(path.name.removesuffix(".gz").rpartition(".")[0] or path.name)
    )


def _text(name: str) -> str:
    """Give a file's name as text: it may hold bytes that are none, which no table can hold."""
    return name.encode("utf-8", "replace").decode("utf-8")


def _catalogued(path: Path) -> Model | None:
    """Find a packed model, `<folder>/<set>/<class>/<name>.ply.gz`, in `<folder>/catalogue.csv`."""
    folders = path.absolute().parents
    if not path.name.endswith(".ply.gz") or len(folders) < 3:
        return None
    catalogue = folders[2] / "catalogue.csv"
    if not catalogue.is_file():
        return None
    key = f"{folders[0].name}/{path.name.removesuffix('.ply.gz')}"
    return next((model for model in read_catalogue(catalogue) if model.key == key), None)
