"""Meshes that go wrong elsewhere, and the chain from a file to the tables that they go through."""

from __future__ import annotations

import numpy as np
import trimesh
from phases_by_files import run_phases

from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.files import make_mesh
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.touches.choosing import touched_places

VIEWPOINTS = 4


def hard_meshes(generator):
    """Give meshes that break other tools, as (vertices, faces), by name."""
    ball = trimesh.creation.icosphere(3)
    box = trimesh.creation.box((1, 1, 1))
    angles = np.linspace(0, 1.5 * np.pi, 25)
    open_shell = trimesh.creation.revolve(
        np.column_stack([np.sin(angles) + 1.1, np.cos(angles)]), sections=24
    )
    sheet = (np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0.0]]), [[0, 1, 2], [0, 2, 3]])
    crossed = trimesh.util.concatenate(
        [box, trimesh.creation.box((0.3, 2, 0.3)).apply_translation((0.2, 0, 0.1))]
    )
    fan = np.array([[0, 0, 0], [0, 1, 0]] + [[np.cos(a), 0.5, np.sin(a)] for a in angles])
    non_manifold = (fan, [[0, 1, 2 + k] for k in range(len(angles))])
    crumbs = trimesh.creation.icosahedron()
    count = 3000
    places = generator.uniform(-1, 1, (count, 1, 3))
    many = (
        (places + 0.01 * crumbs.vertices[None]).reshape(-1, 3),
        (np.arange(count)[:, None, None] * 12 + crumbs.faces[None]).reshape(-1, 3),
    )
    needle = trimesh.creation.cylinder(1e-6, 2.0, sections=16)
    flat_faces = (
        np.vstack([ball.vertices, ball.vertices[:50]]),
        np.vstack(
            [ball.faces, [[k, k, k + 1] for k in range(40)], [[k, 642 + k, k] for k in range(40)]]
        ),
    )
    corner = (
        np.vstack([1e-4 * ball.vertices, [[1, 1, 1], [1, 1, 1 + 1e-6], [1, 1 + 1e-6, 1]]]),
        np.vstack([ball.faces, [[642, 643, 644]]]),
    )
    far_point = (
        np.vstack([box.vertices, 1e4 + 1e-3 * box.vertices]),
        np.vstack([box.faces, box.faces + 8]),
    )
    moebius = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    strip = np.concatenate(
        [
            np.column_stack(
                [
                    (1 + w * np.cos(moebius / 2)) * np.cos(moebius),
                    (1 + w * np.cos(moebius / 2)) * np.sin(moebius),
                    w * np.sin(moebius / 2),
                ]
            )
            for w in (-0.3, 0.3)
        ]
    )
    ring = np.arange(59)
    strip_faces = np.vstack(
        [
            np.column_stack([ring, ring + 1, ring + 60]),
            np.column_stack([ring + 1, ring + 61, ring + 60]),
        ]
    )
    mixed = ball.faces.copy()
    mixed[::2] = mixed[::2, ::-1]
    return {
        "open shell": (open_shell.vertices, open_shell.faces),
        "inward normals": (ball.vertices, ball.faces[:, ::-1]),
        "mixed winding": (ball.vertices, mixed),
        "single sheet": sheet,
        "parts that cross": (crossed.vertices, crossed.faces),
        "an edge of 25 faces": non_manifold,
        "3,000 parts": many,
        "needle, 2e6 times as long as wide": (needle.vertices, needle.faces),
        "faces without area": flat_faces,
        "one triangle": (np.eye(3), [[0, 1, 2]]),
        "one sliver of 1e-12 area": (
            np.array([[0, 0, 0], [1, 0, 0], [0.5, 2e-12, 0]]),
            [[0, 1, 2]],
        ),
        "ball of 1e-4 and a speck in a far corner": corner,
        "box and its copy of a thousandth, 1e4 away": far_point,
        "Möbius strip": (strip, strip_faces),
        "every face ten times": (box.vertices, np.tile(box.faces, (10, 1))),
        "coplanar faces, overlapping": (
            np.array([[0, 0, 0], [2, 0, 0], [0, 0, 2], [1, 0, 1], [-1, 0, 1], [1, 0, -1.0]]),
            [[0, 1, 2], [3, 4, 5]],
        ),
        "all vertices at one point": (np.ones((3, 3)), [[0, 1, 2]]),
        "all vertices on a line": (np.outer([0, 1, 2.0], [1, 1, 1]), [[0, 1, 2]]),
        "no face": (np.eye(3), np.zeros((0, 3), dtype=int)),
        "coordinates of 1e300": (1e300 * box.vertices, box.faces),
        "coordinates of 1e-300": (1e-300 * box.vertices, box.faces),
        "coordinates of 1e-320, denormal": (1e-320 * box.vertices, box.faces),
        "a vertex that is NaN": (
            np.where(np.arange(8)[:, None] == 3, np.nan, box.vertices),
            box.faces,
        ),
        "a face that names no vertex": (box.vertices, np.vstack([box.faces, [[0, 1, 99]]])),
    }


def write_obj(path, vertices, faces):
    """Write what a careless exporter would write; any number goes."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, dtype=float).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (np.asarray(faces).reshape(-1, 3) + 1).tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path


def run_chain(source, folder, seed=7, resolution=64, block=(0, 1, 2, 3), name="mesh"):
    """Go from a model file to the feature table; give the three tables, read back and checked."""
    make_mesh("hard/mesh", Model("hard", "mesh"), source, folder / f"{name}.ply", MeshParameters())
    parameters = ExperimentParameters.from_mapping(
        {
            "seed": seed,
            "viewpoints": {"count": VIEWPOINTS},
            "rendering": {"resolution": resolution},
            # Places out of reach are hard cases.
            "probing": {"unreachable": "keep"},
        }
    )
    found = run_phases("hard/mesh", folder / f"{name}.ply", folder / name, parameters, block)
    located = touched_places(found["fixations"], found["touches"])
    return {"fixations": located, "touches": found["touches"], "features": found["features"]}
