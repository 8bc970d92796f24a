"""Meshes that go wrong elsewhere, and the chain from a file to the tables that they go through."""

import numpy as np
import trimesh
from phases_by_files import run_phases

from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.files import make_mesh
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.touches.choosing import touched_locations

VIEWPOINTS = 4
PARAMETERS = ExperimentParameters.from_mapping(
    {
        "seed": 7,
        "viewpoints": {"count": VIEWPOINTS},
        "rendering": {"resolution": 64},
        # Places out of reach are hard cases.
        "probing": {"unreachable": "keep"},
    }
)


def hard_meshes(generator):
    """Return meshes that break other tools, as (vertices, faces), by name."""
    ball, box = trimesh.creation.icosphere(3), trimesh.creation.box((1, 1, 1))
    needle = trimesh.creation.cylinder(1e-6, 2.0, sections=16)
    bar = trimesh.creation.box((0.3, 2, 0.3)).apply_translation((0.2, 0, 0.1))
    crossed = trimesh.util.concatenate([box, bar])
    angles = np.linspace(0, 1.5 * np.pi, 25)
    sine, cosine = np.sin(angles), np.cos(angles)
    shell = trimesh.creation.revolve(np.column_stack([sine + 1.1, cosine]), sections=24)
    fan = np.vstack([[[0, 0, 0], [0, 1, 0]], np.column_stack([cosine, 0 * angles + 0.5, sine])])
    crumb = trimesh.creation.icosahedron()
    numbers = np.arange(3000)[:, None, None]
    places = generator.uniform(-1, 1, (3000, 1, 3))
    k = np.arange(40)
    flat = np.concatenate([np.stack([k, k, k + 1], 1), np.stack([k, 642 + k, k], 1)])
    speck = [[1, 1, 1], [1, 1, 1 + 1e-6], [1, 1 + 1e-6, 1]]
    mixed = ball.faces.copy()
    mixed[::2] = mixed[::2, ::-1]
    squares = [[0, 0, 0], [2, 0, 0], [0, 0, 2], [1, 0, 1], [-1, 0, 1], [1, 0, -1.0]]
    nothing = np.where(np.arange(8)[:, None] == 3, np.nan, box.vertices)
    return {
        "open shell": (shell.vertices, shell.faces),
        "inward normals": (ball.vertices, ball.faces[:, ::-1]),
        "mixed winding": (ball.vertices, mixed),
        "single sheet": ([[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0.0]], [[0, 1, 2], [0, 2, 3]]),
        "parts that cross": (crossed.vertices, crossed.faces),
        "an edge of 25 faces": (fan, [[0, 1, 2 + face] for face in range(25)]),
        "3,000 parts": (places + 0.01 * crumb.vertices, 12 * numbers + crumb.faces),
        "needle, 2e6 times as long as wide": (needle.vertices, needle.faces),
        "faces without area": (
            np.vstack([ball.vertices, ball.vertices[:50]]),
            np.vstack([ball.faces, flat]),
        ),
        "one triangle": (np.eye(3), [[0, 1, 2]]),
        "one sliver of 1e-12 area": ([[0, 0, 0], [1, 0, 0], [0.5, 2e-12, 0]], [[0, 1, 2]]),
        "ball of 1e-4 and a speck in a far corner": (
            np.vstack([1e-4 * ball.vertices, speck]),
            np.vstack([ball.faces, [[642, 643, 644]]]),
        ),
        "box and its copy of a thousandth, 1e4 away": (
            np.vstack([box.vertices, 1e4 + 1e-3 * box.vertices]),
            np.vstack([box.faces, box.faces + 8]),
        ),
        "Möbius strip": moebius_strip(),
        "every face ten times": (box.vertices, np.tile(box.faces, (10, 1))),
        "coplanar faces, overlapping": (squares, [[0, 1, 2], [3, 4, 5]]),
        "all vertices at one point": (np.ones((3, 3)), [[0, 1, 2]]),
        "all vertices on a line": (np.outer([0, 1, 2.0], [1, 1, 1]), [[0, 1, 2]]),
        "no face": (np.eye(3), []),
        "coordinates of 1e300": (1e300 * box.vertices, box.faces),
        "coordinates of 1e-300": (1e-300 * box.vertices, box.faces),
        "coordinates of 1e-320, denormal": (1e-320 * box.vertices, box.faces),
        "a vertex that is NaN": (nothing, box.faces),
        "a face that names no vertex": (box.vertices, np.vstack([box.faces, [[0, 1, 99]]])),
    }


def moebius_strip():
    """Return a strip of 59 squares with half a turn, open where its ends would meet."""
    turn, ring = np.linspace(0, 2 * np.pi, 60, endpoint=False), np.arange(59)
    rims = []
    for aside in (-0.3, 0.3):
        radius = 1 + aside * np.cos(turn / 2)
        rim = radius * np.cos(turn), radius * np.sin(turn), aside * np.sin(turn / 2)
        rims.append(np.column_stack(rim))
    halves = [(ring, ring + 1, ring + 60), (ring + 1, ring + 61, ring + 60)]
    return np.vstack(rims), np.vstack([np.column_stack(half) for half in halves])


def write_obj(path, vertices, faces):
    """Write what a careless exporter would write; any number goes."""
    vertices = np.asarray(vertices, dtype=float).reshape(-1, 3)
    faces = np.asarray(faces, dtype=int).reshape(-1, 3) + 1
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in faces.tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path


def run_chain(source, folder, block=range(VIEWPOINTS)):
    """Go from a model file to the feature table; give the three tables, read back and checked."""
    mesh = folder / "mesh.ply"
    make_mesh("hard/mesh", Model("hard", "mesh"), source, mesh, MeshParameters())
    found = run_phases("hard/mesh", mesh, folder / "tables", PARAMETERS, block)
    located = touched_locations(found["fixations"], found["touches"])
    return {"fixations": located, "touches": found["touches"], "features": found["features"]}
