"""Write the mesh files of objects from their models."""

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
    """Write the mesh files ``<class>/<name>.ply`` of objects in `folder`.

    `models` and `sources` have keys `class/name`; the model is None for an own model. `seed` is the seed of the
    random turns, if `parameters` ask for turns.
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
    """Write the mesh file of one object; for an unusable own model, write an empty mesh with the reason.

    Raises `MeshError`, and writes nothing, if a model of the catalogue can't be read or has no area.
    """
    category, name = key.split("/")
    try:
        surface = prepare_object(model or Model(category, name), source, parameters).surface
        if parameters.turns != "none":
            rotation = draw_rotation(parameters.turns, key, seed, parameters.turn_draw)
            surface = turn_surface(surface, rotation)
    except MeshError as error:
        if model is not None:
            raise
        write_set_aside(output, str(error))
    else:
        write_surface(surface, output)
