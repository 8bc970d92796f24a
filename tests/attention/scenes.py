"""Small surfaces whose fixations are known."""

from dataclasses import replace

import numpy as np
import trimesh
from numerics.surfaces import of_trimesh
from scipy.spatial.transform import Rotation

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.geometry.raycasting import RayCaster


def sphere():
    return of_trimesh(trimesh.creation.icosphere(subdivisions=4, radius=0.9))


def angles(points, direction):
    lengths = np.linalg.norm(points, axis=1) * np.linalg.norm(direction)
    return np.arccos(np.clip(points @ np.asarray(direction) / lengths, -1, 1))


def sphere_with_bump(direction, height=0.08, width=0.1):
    """A sphere with a bump in a direction."""
    plain = sphere()
    growth = 1 + height * np.exp(-0.5 * (angles(plain.vertices, direction) / width) ** 2)
    return replace(plain, vertices=plain.vertices * growth[:, None])


def sphere_with_patch(direction, colour=(40, 40, 40), radius=0.15):
    """A sphere with a spot of another colour."""
    plain = sphere()
    colours = plain.face_colours.copy()
    colours[angles(plain.triangles.mean(axis=1), direction) < radius] = colour
    return replace(plain, face_colours=colours)


def turned(surface, degrees):
    """Turn about the vertical axis, from +z towards +x."""
    rotation = Rotation.from_euler("y", degrees, degrees=True)
    return replace(surface, vertices=rotation.apply(surface.vertices))


def mirrored(surface):
    """Mirror left and right; faces keep their outer side."""
    across = np.array([-1.0, 1.0, 1.0])
    return replace(surface, vertices=surface.vertices * across, faces=surface.faces[:, ::-1])


def look(surface, cameras, attention=None, modes=None, background=0.85, **further):
    """Render a surface and compute its fixations."""
    attention = AttentionParameters() if attention is None else attention
    rendering = RenderingParameters(background=background)
    views = render_views(RayCaster(surface), cameras, rendering, modes)
    return views, attend(**views.attend_arguments(), parameters=attention, **further)
