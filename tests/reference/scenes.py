"""Small scenes of many kinds: vertices (v, 3), faces (f, 3) and sRGB colours of faces (f, 3), uint8.

Vertices are numbers of float32, as in prepared meshes. No edge has more than two faces, and no face is a sliver.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh

GREY = (160, 160, 160)


@dataclass(frozen=True)
class Scene:
    """A mesh with coloured faces."""

    vertices: np.ndarray
    faces: np.ndarray
    colours: np.ndarray


def of_mesh(mesh, colours=GREY):
    """Return a scene of a trimesh; colours are one or one per face."""
    faces = np.asarray(mesh.faces, dtype=np.int64)
    painted = np.broadcast_to(np.asarray(colours, dtype=np.uint8), (len(faces), 3)).copy()
    vertices = np.asarray(mesh.vertices, dtype=np.float32).astype(np.float64)
    return Scene(vertices, faces, painted)


def by_place(mesh, rule):
    """Return a scene whose faces are coloured by a rule of their centres."""
    centres = np.asarray(mesh.triangles).mean(axis=1)
    return of_mesh(mesh, [rule(centre) for centre in centres])


def box(edges, place=(0, 0, 0)):
    """Return a box of twelve triangles."""
    mesh = trimesh.creation.box(edges)
    mesh.apply_translation(place)
    return mesh


def ball(radius, subdivisions=2, place=(0, 0, 0)):
    """Return a ball of smooth facets."""
    mesh = trimesh.creation.icosphere(subdivisions, radius=radius)
    mesh.apply_translation(place)
    return mesh


def sheet(height, cells=6):
    """Return an open sheet over the square of edge 1.4 with the height of a function of x and z."""
    side = np.linspace(-0.7, 0.7, cells + 1)
    x, z = (plane.ravel() for plane in np.meshgrid(side, side))
    faces = []
    for row in range(cells):
        for column in range(cells):
            first = row * (cells + 1) + column
            below = first + cells + 1
            faces += [(first, below, first + 1), (first + 1, below, below + 1)]
    return trimesh.Trimesh(np.stack([x, height(x, z), z], axis=1), faces, process=False)


def cup():
    """Return a thick-walled cup, open at the top: an outline turned about the vertical axis."""
    outline = [(0, -0.6), (0.5, -0.6), (0.6, 0.6), (0.45, 0.6), (0.35, -0.4), (0, -0.4)]
    return trimesh.creation.revolve(outline, sections=10, transform=_upright())


def _upright():
    return trimesh.transformations.rotation_matrix(-np.pi / 2, (1, 0, 0))


def _mixed_winding():
    mesh = sheet(lambda x, z: 0.3 * x**2 - 0.2 * z, cells=4)
    faces = mesh.faces.copy()
    faces[::3] = faces[::3, ::-1]
    return trimesh.Trimesh(mesh.vertices, faces, process=False)


def _random_colours(faces, seed):
    return np.random.default_rng(seed).integers(0, 256, (faces, 3))


def small_scenes():
    """Return the small scenes by name."""
    torus = trimesh.creation.torus(0.65, 0.25, major_sections=14, minor_sections=8)
    cone = trimesh.creation.cone(0.5, 1.2, sections=14, transform=_upright())
    tube = trimesh.creation.cylinder(0.4, 1.4, sections=12, transform=_upright())
    bumps = trimesh.util.concatenate(
        [ball(0.16, 1, (0.45 * x, 0.45 * y, 0.1 * x)) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    )
    parts = trimesh.util.concatenate(
        [box((0.5, 1.0, 0.4), (-0.5, 0, 0)), box((0.5, 0.6, 0.5), (0.45, -0.2, 0.2))]
    )
    return {
        "cube": of_mesh(box((1.0, 1.0, 1.0))),
        "ball of one colour": of_mesh(ball(0.9)),
        "ball in halves": by_place(
            ball(0.9, 2), lambda at: (200, 40, 30) if at[0] > 0 else (40, 180, 60)
        ),
        "ball with a dark spot": by_place(
            ball(0.8, 2), lambda at: (25, 20, 40) if at[0] > 0.5 else (170, 170, 170)
        ),
        "torus": of_mesh(torus),
        "torus off the centre": by_place(
            torus.copy().apply_translation((0.3, 0.2, 0)),
            lambda at: (220, 210, 40) if at[1] > 0.2 else (60, 70, 190),
        ),
        "thin plate": of_mesh(box((1.4, 0.05, 0.8))),
        "upright plate": of_mesh(box((0.03, 1.5, 0.5)), _random_colours(12, 1)),
        "two parts": of_mesh(parts, _random_colours(24, 2)),
        "nine balls": of_mesh(bumps),
        "nine balls, one red": by_place(
            bumps, lambda at: (210, 30, 30) if at[0] > 0.3 and at[1] > 0.3 else (150, 160, 150)
        ),
        "cup": of_mesh(cup(), (120, 90, 200)),
        "cone": of_mesh(cone, (230, 230, 230)),
        "tube of facets": of_mesh(tube, _random_colours(len(tube.faces), 3)),
        "bent sheet": of_mesh(sheet(lambda x, z: 0.4 * np.sin(3 * x) * z)),
        "sheet of mixed windings": of_mesh(_mixed_winding(), (90, 140, 110)),
        "one triangle": Scene(
            np.array([[-0.75, -0.5, 0.25], [0.875, -0.25, 0.0], [0.0, 0.75, -0.125]]),
            np.array([[0, 1, 2]]),
            np.array([[250, 120, 0]], dtype=np.uint8),
        ),
        "black and bright": of_mesh(
            ball(0.7, 1), [(0, 0, 0), (255, 255, 255), (3, 1, 2), (128, 0, 0)] * 20
        ),
        "stairs": of_mesh(
            trimesh.util.concatenate(
                [box((0.5, 0.3 * k, 0.5), (0.56 * (k - 2), 0.15 * k - 0.4, 0)) for k in (1, 2, 3)]
            )
        ),
        "far corner": by_place(
            ball(0.3, 1, (-0.6, 0.55, 0.2)),
            lambda at: (80, 80, 200) if at[2] > 0.2 else (90, 60, 60),
        ),
    }


SCENES = small_scenes()
PAPER = sorted((Path(__file__).parents[2] / "meshes/paper").glob("*/*.ply.gz"))
