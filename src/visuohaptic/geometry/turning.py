"""Rotate objects into random poses."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from meshreaders.base.rotations import rotation_matrices
from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.geometry.elementary import sin_cos
from visuohaptic.geometry.surface import Surface, as_stored
from visuohaptic.geometry.vectors import product

Turns = Literal["none", "vertical", "any"]
"""How objects are rotated: not at all, about the vertical axis, or about any axis."""


def draw_rotation(turns: Turns, key: str, seed: int, draw: int = 0) -> FloatArray:
    """Return a random rotation.

    Parameters
    ----------
    turns : {"none", "vertical", "any"}
        ``vertical`` draws a uniform angle about y. ``any`` draws uniformly from all rotations (K. Shoemake, "Uniform random rotations", Graphics Gems III, 1992).
    key : str
        Name of the rotated thing, such as an object, ``class/name``.
    seed, draw : int
        The seed, and the index of the draw.

    Returns
    -------
    ndarray of shape (3, 3)
        Matrix that rotates column vectors; the same bits on every processor.
    """
    if turns == "none":
        return np.eye(3)
    generator = spawn_generator(seed, "turns", turns, key, draw)
    if turns == "vertical":
        sine, cosine = (float(value) for value in sin_cos(generator.uniform(0.0, 2.0 * math.pi)))
        return np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    share, *angles = generator.uniform(size=3) * [1.0, 2.0 * math.pi, 2.0 * math.pi]
    (sine, other_sine), (cosine, other_cosine) = sin_cos(angles)
    first, second = math.sqrt(1.0 - share), math.sqrt(share)
    quaternion = [first * sine, first * cosine, second * other_sine, second * other_cosine]
    return rotation_matrices(np.array([quaternion]))[0]


def turn_surface(surface: Surface, rotation: FloatArray) -> Surface:
    """Rotate a prepared surface about the origin by a matrix (3, 3), and round the vertices to float32.

    The rounding is that of stored meshes. Faces without area after rounding are dropped.
    """
    turned = as_stored(replace(surface, vertices=product(surface.vertices, rotation.T)))
    return take_faces(turned, turned.face_areas > 0)


def take_faces(surface: Surface, keep: BoolArray) -> Surface:
    """Return the faces for which `keep` (f,) is true, with only the vertices of these faces."""
    used, renumbered = np.unique(surface.faces[keep], return_inverse=True)
    return Surface(
        surface.vertices[used],
        renumbered.reshape(-1, 3).astype(np.int64),
        surface.face_colours[keep],
        None if surface.texture is None else surface.texture.take(keep),
        notes=surface.notes,
    )
