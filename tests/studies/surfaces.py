"""A few small objects of two classes, and what a small run makes of them."""

from functools import partial

import numpy as np
import trimesh

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface, object_of, read_surface, write_surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import run
from visuohaptic.studies.recomputing import Sources
from visuohaptic.tables.phases import FEATURES, FIXATIONS, TOUCHES
from visuohaptic.tables.schema import join_parts, write_table

RUN = ExperimentParameters.from_mapping(
    {
        "viewpoints": {"count": 4},
        "rendering": {"resolution": 48},
        "attention": {"fixations": 2},
        "probing": {"strategies": ["fixation"]},
        "sensor": {"resolution": 16},
        "recognition": {"touches": 2},
        "cost": {
            "touches": [1, 2, 3],
            "viewpoints": [1, 2, 4],
            "imprint_resolutions": [8, 16],
            "view_resolutions": [24, 48],
            "lean_view_resolution": 32,
            "frontier_viewpoints": [1, 4],
            "objects": 2,
            "rounds": 2,
        },
    }
)


def small_surfaces():
    """Return rings and boxes by their keys."""
    meshes = {}
    for number, width in enumerate((0.15, 0.25, 0.35)):
        meshes[f"ring/ring{number}"] = trimesh.creation.torus(0.6, width, 16, 12)
        meshes[f"box/box{number}"] = trimesh.creation.box((0.5, 0.7 + width, 0.4 + width))
    return {key: surface_of(mesh) for key, mesh in meshes.items()}


def surface_of(mesh):
    """Return a mesh as a surface within the unit sphere, half of it red."""
    faces = np.asarray(mesh.faces, dtype=np.int64)
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    colours = np.full((len(faces), 3), 120, dtype=np.uint8)
    colours[: len(faces) // 2] = (200, 40, 40)
    return Surface(vertices / np.linalg.norm(vertices, axis=1).max(), faces, colours)


def run_tables(surfaces, parameters=RUN):
    """Return the locations, touches and features that a run would have made."""
    viewpoints = range(parameters.viewpoints.total)
    made = [
        run(Subject(key, partial(RayCaster, surface), viewpoints), parameters)
        for key, surface in surfaces.items()
    ]
    names = ("fixations", "touches", "features")
    return [join_parts(FEATURES, [one[name] for one in made]) for name in names]


def write_meshes(folder, surfaces):
    """Write surfaces as meshes of a run, and return their files."""
    meshes = [folder / f"{key}.ply" for key in surfaces]
    for mesh, surface in zip(meshes, surfaces.values(), strict=True):
        mesh.parent.mkdir(parents=True, exist_ok=True)
        write_surface(surface, mesh)
    return meshes


def write_sources(folder, surfaces, run=RUN):
    """Write the files of a run that studies read, and return the sources and the file of features."""
    meshes = write_meshes(folder, surfaces)
    files = [folder / f"{name}.parquet" for name in ("fixations", "touches", "features")]
    # Files hold float32, so what is made of them differs a little from what is made in memory.
    surfaces = {object_of(mesh): read_surface(mesh) for mesh in meshes}
    schemas = (FIXATIONS, TOUCHES, FEATURES)
    for schema, file, table in zip(schemas, files, run_tables(surfaces, run), strict=True):
        write_table(schema, table, file)
    tables = {"fixations": files[:1], "touches": files[1:2]}
    return Sources(meshes, tables), files[2]
