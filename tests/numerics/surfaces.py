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
    """Give vectors of one length in all directions."""
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
    """Give closed surfaces within the unit sphere, by name."""
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
    """Give a ball of 20 · 4^level triangles, its vertices rounded to float32."""
    return float32_exact(of_trimesh(trimesh.creation.icosphere(level, radius=radius)))


def draw_triangles(generator, count, size=0.4):
    """Give random triangles of sizes over six decades, slivers among them."""
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


@cache
def lopsided():
    """Give a coloured object without any symmetry, of several parts."""
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
