"""A few small objects of two classes, and what a small run makes of them."""

import numpy as np
import pyarrow as pa
import trimesh

from visuohaptic.features.describing import describe_touches
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.errors import RunTables, find_fixations
from visuohaptic.touches.touching import touch_locations, touch_table

RUN = ExperimentParameters.from_mapping(
    {
        "viewpoints": {"count": 4},
        "rendering": {"resolution": 48},
        "attention": {"fixations": 2},
        "probing": {"strategies": ["fixation"]},
        "sensor": {"resolution": 16},
        "recognition": {"touches": 2, "intervals": {"bootstrap_samples": 200}},
        "cost": {
            "touches": [1, 2, 3],
            "viewpoints": [1, 2, 4],
            "imprint_resolutions": [4, 16],
            "view_resolutions": [24, 48],
            "lean_view_resolution": 32,
            "objects": 2,
            "rounds": 2,
        },
    }
)


def small_surfaces():
    """Give rings and boxes by their keys."""
    meshes = {}
    for number, width in enumerate((0.15, 0.25, 0.35)):
        meshes[f"ring/ring{number}"] = trimesh.creation.torus(0.6, width, 16, 12)
        meshes[f"box/box{number}"] = trimesh.creation.box((0.5, 0.7 + width, 0.4 + width))
    return {key: surface_of(mesh) for key, mesh in meshes.items()}


def surface_of(mesh):
    """Give a mesh as a surface within the unit sphere, half of it red."""
    faces = np.asarray(mesh.faces, dtype=np.int64)
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    colours = np.full((len(faces), 3), 120, dtype=np.uint8)
    colours[: len(faces) // 2] = (200, 40, 40)
    return Surface(vertices / np.linalg.norm(vertices, axis=1).max(), faces, colours)


def run_tables(surfaces, run=RUN):
    """Give what a run would have made."""
    fixations, features = [], []
    for key, surface in surfaces.items():
        caster = RayCaster(surface)
        found = find_fixations(caster, key, run)
        felt = touch_locations(caster, found, run.sensor, run.scene, run.seed)
        fixations.append(found)
        features.append(describe_touches(touch_table(found, felt), run.features))
    return RunTables(pa.concat_tables(fixations), pa.concat_tables(features))
