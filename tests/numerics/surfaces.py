"""Surfaces that checks touch, look at and cast rays at."""

from dataclasses import replace
from functools import cache

import numpy as np
import trimesh

from visuohaptic.geometry.surface import Surface


def pick(generator, low, high):
    """Draw a number between two ends; one draw in eight is an end itself."""
    if generator.random() < 0.125:
        return float(generator.choice([low, high]))
    return float(generator.uniform(low, high))


def random_vectors(generator, count, length=1.0):
    """Return vectors of one length in all directions."""
    vectors = generator.normal(size=(count, 3))
    return vectors * (length / np.linalg.norm(vectors, axis=1, keepdims=True))


def build_plain_surface(vertices, faces, colours=(160, 160, 160)):
    """Make a surface; one colour stands for all faces, and grey for none."""
    triangles = np.asarray(faces, dtype=np.int64).reshape(-1, 3)
    painted = np.broadcast_to(np.asarray(colours, dtype=np.uint8), (len(triangles), 3)).copy()
    return Surface(np.asarray(vertices, dtype=np.float64), triangles, painted)


def of_trimesh(mesh, colours=(160, 160, 160)):
    """Make a surface of a mesh of trimesh."""
    return build_plain_surface(mesh.vertices, mesh.faces, colours)


def float32_exact(surface):
    """Round the vertices to float32, so that caster and oracle see the same surface; images are left out."""
    vertices = surface.vertices.astype(np.float32).astype(np.float64)
    return Surface(vertices, surface.faces, surface.face_colours)


def moved(surface, scale, shift=0.0):
    """Scale a surface after a shift."""
    return replace(surface, vertices=scale * (surface.vertices + shift))


def far_off(generator, surface):
    """Move a surface by 1 to 1e6 and scale it; give it, and the powers of ten of its size and offset."""
    size, offset = pick(generator, -6, 6), pick(generator, 0, 6)
    (towards,) = random_vectors(generator, 1, 10.0**offset)
    return moved(surface, 10.0**size, towards), size, offset


@cache
def closed_shapes():
    """Return closed surfaces within the unit sphere, by name."""
    made = {
        "ball": trimesh.creation.icosphere(3),
        "torus": trimesh.creation.torus(0.6, 0.25, 24, 16),
        "box": trimesh.creation.box((1.0, 0.75, 0.5)),
        "needle": trimesh.creation.cylinder(0.01, 1.9, sections=64),
        "fine ball": trimesh.creation.icosphere(4),
    }
    return {name: float32_exact(of_trimesh(mesh)) for name, mesh in made.items()}


@cache
def ball(level, radius=1.0):
    """Return a ball of 20 · 4^level triangles, its vertices rounded to float32."""
    return float32_exact(of_trimesh(trimesh.creation.icosphere(level, radius=radius)))


def draw_triangles(generator, count, size=0.4):
    """Return random triangles of sizes over six decades, slivers among them."""
    centres = generator.uniform(-0.7, 0.7, (count, 1, 3))
    scale = size * 10.0 ** generator.uniform(-3, 0, (count, 1, 1))
    corners = centres + scale * generator.normal(size=(count, 3, 3))
    thin = generator.random(count) < 0.3
    share = generator.random((count, 1))
    width = 10.0 ** generator.uniform(-9, -2, (count, 1))
    along = corners[:, 0] * (1 - share) + corners[:, 1] * share
    corners[:, 2] = np.where(thin[:, None], along + width * (corners[:, 2] - along), corners[:, 2])
    corners = np.clip(corners, -1, 1)
    faces = np.arange(3 * count).reshape(-1, 3)
    return float32_exact(build_plain_surface(corners.reshape(-1, 3), faces))


def pages(degrees, *, wound=False, cells=1):
    """Return a rectangle per angle, like pages of a book: all share one edge, which is the y axis.

    If `wound`, every second page is wound the other way. `cells` are the rectangles along the edge.
    """
    turns = np.radians(np.asarray(degrees, dtype=float))
    heights = np.linspace(-0.5, 0.5, cells + 1)
    spine = np.outer(heights, [0.0, 1.0, 0.0])
    rims = [spine + np.array([np.cos(turn), 0.0, np.sin(turn)]) for turn in turns]
    low = np.arange(cells)
    faces = []
    for page in range(len(turns)):
        rim = low + (page + 1) * (cells + 1)
        corners = [low, low + 1, rim], [low + 1, rim + 1, rim]
        faces += [np.stack(each[:: -1 if wound and page % 2 else 1], axis=1) for each in corners]
    colours = np.repeat(
        np.random.default_rng(5).integers(60, 220, (len(turns), 3)), 2 * cells, axis=0
    )
    return build_plain_surface(np.concatenate([spine, *rims]), np.concatenate(faces), colours)


def tube(sides=24, *, walls=1, twist=0.0):
    """Return a tube about the y axis, open at both ends; the second wall cuts each quadrangle along the other diagonal.

    `twist` is the angle from one ring of vertices to the next, radians. Without twist the walls lie on each other.
    """
    levels = np.linspace(-0.6, 0.6, 5)
    rings = []
    for level, height in enumerate(levels):
        turns = 2 * np.pi * np.arange(sides) / sides + twist * level
        rings.append(
            np.column_stack([0.5 * np.cos(turns), 0 * turns + height, 0.5 * np.sin(turns)])
        )
    vertices = np.concatenate(rings)
    start = np.arange(sides * (len(levels) - 1))
    following = np.where(start % sides == sides - 1, start + 1 - sides, start + 1)
    above, across = start + sides, following + sides
    cuts = [[(start, following, above), (following, across, above)]]
    cuts += [[(start, across, above), (start, following, across)]]
    faces = [np.stack(corners, axis=1) for cut in cuts[:walls] for corners in cut]
    return build_plain_surface(vertices, np.concatenate(faces))


@cache
def branching_shapes():
    """Return surfaces with edges of more than two faces, by name."""
    left, right = (
        trimesh.creation.box(bounds=([low, -0.4, -0.3], [low + 0.7, 0.4, 0.3])) for low in (-0.7, 0)
    )
    touching = trimesh.util.concatenate([left, right])
    return {
        "book of five pages": pages([0, 20, 40, 60, 80], wound=True),
        "fan of 25 faces": pages(np.linspace(0, 270, 25)),
        "crossed plates": pages([0, 90, 180, 270], cells=3),
        "star of five plates": pages([0, 72, 144, 216, 288], wound=True),
        "plate on a plate": pages([3, 90, 180], cells=2),
        "double-walled tube": tube(walls=2, twist=0.1),
        "boxes side by side": of_trimesh(touching),
    }


def points_on_faces(surface, weights):
    """Return a face index and barycentric weights (f, 3) per face of a surface, for the same points in any description.

    `weights` (f, 3) are for faces in the order of their corners' places, and for corners in that order.
    """
    _, places = np.unique(surface.triangles.reshape(-1, 3), axis=0, return_inverse=True)
    places = places.reshape(-1, 3)
    corners = np.argsort(places, axis=1)
    faces = np.lexsort(np.take_along_axis(places, corners, axis=1).T[::-1])
    found = np.empty_like(weights)
    np.put_along_axis(found, corners[faces], weights, axis=1)
    return faces, found


@cache
def lopsided():
    """Return a coloured object without any symmetry, of several parts."""
    body = trimesh.creation.icosphere(subdivisions=4, radius=0.55)
    box = trimesh.creation.box(extents=(0.5, 0.9, 0.3))
    box.apply_transform(trimesh.transformations.rotation_matrix(0.5, (0.3, 1.0, 0.2)))
    box.apply_translation((0.45, 0.25, 0.1))
    cone = trimesh.creation.cone(radius=0.25, height=0.6, sections=40)
    cone.apply_transform(trimesh.transformations.rotation_matrix(-1.2, (1.0, 0.2, 0.4)))
    cone.apply_translation((-0.45, 0.35, -0.2))
    foot = trimesh.creation.cylinder(radius=0.12, height=0.5, sections=40)
    foot.apply_translation((-0.2, -0.6, 0.3))
    parts = [body, box, cone, foot]
    colours = np.array([(200, 170, 60), (60, 110, 180), (190, 60, 60), (70, 150, 80)])
    owners = np.repeat(np.arange(4), [len(part.faces) for part in parts])
    return of_trimesh(trimesh.util.concatenate(parts), colours[owners])
