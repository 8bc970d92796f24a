"""From models' files to mesh files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import write_set_aside, write_surface
from visuohaptic.geometry.turning import draw_rotation, turn_surface
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import prepare_object


def make_meshes(
    models: Mapping[str, Model | None],
    sources: Mapping[str, str | Path],
    folder: str | Path,
    parameters: MeshParameters,
    seed: int,
) -> None:
    """Make the mesh files ``<class>/<name>.ply`` of some objects, by `class/name`; own models are None.

    The seed decides how objects are turned, if `parameters` ask for that.
    """
    for key, model in models.items():
        make_mesh(key, model, sources[key], Path(folder) / f"{key}.ply", parameters, seed)


def make_mesh(
    key: str,
    model: Model | None,
    source: str | Path,
    output: str | Path,
    parameters: MeshParameters,
    seed: int = 0,
) -> None:
    """Make the mesh file of one object; of an own model that can't be used, an empty one with the reason.

    Raises `MeshError` if a catalogued model can't be read or has nothing to touch; nothing is
    written then.
    """
    category, name = key.split("/")
    try:
        surface = prepare_object(model or Model(category, name), source, parameters)
        if parameters.turns != "none":
            rotation = draw_rotation(parameters.turns, key, seed, parameters.turn_draw)
            surface = turn_surface(surface, rotation)
    except MeshError as error:
        if model is not None:
            raise
        write_set_aside(output, str(error))
    else:
        write_surface(surface, output)
