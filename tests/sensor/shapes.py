"""Shapes with known heights, as triangle surfaces, for the sensor's tests."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from visuohaptic.surface import Surface


def surface_of(vertices, faces) -> Surface:
    faces = np.asarray(faces, dtype=np.int64).reshape(-1, 3)
    return Surface(
        np.asarray(vertices, dtype=np.float64),
        faces,
        np.full((len(faces), 3), 128, dtype=np.uint8),
    )


def joined(*surfaces: Surface) -> Surface:
    offsets = np.cumsum([0, *(len(surface.vertices) for surface in surfaces[:-1])])
    return surface_of(
        np.concatenate([surface.vertices for surface in surfaces]),
        np.concatenate(
            [surface.faces + offset for surface, offset in zip(surfaces, offsets, strict=True)]
        ),
    )


def sheet(height: Callable, half: float = 0.5, cells: int = 200) -> Surface:
    """The graph y = height(x, z) over a square, y up; its triangles wind counter-clockwise from above."""
    along = np.linspace(-half, half, cells + 1)
    x, z = np.meshgrid(along, along, indexing="ij")
    vertices = np.stack([x, height(x, z), z], axis=-1).reshape(-1, 3)
    corner = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.concatenate(
        [np.stack([a, d, c], axis=-1).reshape(-1, 3), np.stack([a, c, b], axis=-1).reshape(-1, 3)]
    )
    return surface_of(vertices, faces)


def profile_of_revolution(radii, heights, segments: int = 96) -> Surface:
    """A surface of revolution about y; radius 0 closes an end."""
    angles = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    radii, heights = np.asarray(radii, float), np.asarray(heights, float)
    ring = np.stack([np.cos(angles), np.zeros(segments), np.sin(angles)], axis=1)
    vertices = radii[:, None, None] * ring + heights[:, None, None] * np.array([0, 1, 0])
    index = np.arange(len(radii) * segments).reshape(len(radii), segments)
    nxt = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1], nxt[:-1], nxt[1:], index[1:]
    faces = np.concatenate(
        [np.stack([a, d, c], axis=-1).reshape(-1, 3), np.stack([a, c, b], axis=-1).reshape(-1, 3)]
    )
    surface = surface_of(vertices.reshape(-1, 3), faces)
    return surface_of(surface.vertices, surface.faces[surface.face_areas > 1e-14])


def tube(path, radius: float, sides: int = 24) -> Surface:
    """A tube of round section along a path of points, shape (k, 3)."""
    path = np.asarray(path, float)
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along, [0.3, 0.2, 1.0])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(along, side)
    angles = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    vertices = (
        path[:, None]
        + radius * np.cos(angles)[None, :, None] * side[:, None]
        + radius * np.sin(angles)[None, :, None] * other[:, None]
    )
    index = np.arange(len(path) * sides).reshape(len(path), sides)
    nxt = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1], nxt[:-1], nxt[1:], index[1:]
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    return surface_of(vertices.reshape(-1, 3), faces.reshape(-1, 3))


def box(lower, upper) -> Surface:
    lower, upper = np.asarray(lower, float), np.asarray(upper, float)
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    faces = [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]  # fmt: skip
    return surface_of(lower + corners * (upper - lower), faces)


@dataclass(frozen=True)
class Probe:
    """A hard place to touch: an object, where, and from where."""

    surface: Surface
    point: tuple[float, float, float]
    normal: tuple[float, float, float]


def hard_probes() -> dict[str, Probe]:
    angle = np.linspace(0, np.pi / 2, 60)
    bowl = profile_of_revolution(
        np.concatenate([0.6 * np.sin(angle), 0.63 * np.sin(angle[::-1])]),
        np.concatenate([-0.6 * np.cos(angle), -0.63 * np.cos(angle[::-1])]),
    )
    turns = np.linspace(0, 2 * np.pi * 8, 600)
    thread = joined(
        profile_of_revolution([0, 0.2, 0.2, 0], [-0.6, -0.6, 0.6, 0.6]),
        tube(
            np.stack([0.2 * np.cos(turns), -0.5 + turns / turns[-1], 0.2 * np.sin(turns)], axis=1),
            0.03,
        ),
    )
    loop = np.linspace(-np.pi / 2, np.pi / 2, 40)
    cup = joined(
        profile_of_revolution([0, 0.4, 0.4, 0.37, 0.37, 0], [-0.5, -0.5, 0.5, 0.5, -0.47, -0.47]),
        tube(
            np.stack([0.4 + 0.3 * np.cos(loop), 0.3 * np.sin(loop), 0 * loop], axis=1), 0.04
        ),
    )
    leaf = sheet(lambda x, z: 0.15 * np.sin(3 * x) + 0.05 * np.cos(9 * z), half=0.4, cells=60)
    slope = 1 / np.hypot(0.45, 1)
    blade = surface_of(
        [[-0.8, -0.3, 0.04], [0.8, -0.3, 0.04], [0.8, -0.3, -0.04], [-0.8, -0.3, -0.04], [-0.8, 0.3, 0], [0.8, 0.3, 0]],
        [[0, 1, 5], [0, 5, 4], [2, 3, 4], [2, 4, 5], [0, 4, 3], [1, 2, 5], [0, 3, 2], [0, 2, 1]],
    )  # fmt: skip
    cone = profile_of_revolution([0, 0.5, 0], [-0.5, -0.5, 0.7])
    return {
        "bowl, inside": Probe(bowl, (0, -0.6, 0), (0, 1, 0)),
        "screw thread, groove": Probe(thread, (0.2, 0.0625, 0.0), (1, 0, 0)),
        "screw thread, crest": Probe(thread, (0.23, 0.0, 0.0), (1, 0, 0)),
        "cup, inner wall": Probe(cup, (0.37, 0.1, 0), (-1, 0, 0)),
        "cup, floor": Probe(cup, (0.2, -0.47, 0), (0, 1, 0)),
        "cup, handle": Probe(cup, (0.74, 0.0, 0), (1, 0, 0)),
        "cup, under the handle": Probe(cup, (0.66, 0.0, 0), (-1, 0, 0)),
        "leaf": Probe(leaf, (0, 0.05, 0), (-0.45 * slope, slope, 0)),
        "leaf, rim": Probe(leaf, (0.4, float(0.15 * np.sin(1.2) + 0.05), 0), (0, 1, 0)),
        "knife edge": Probe(blade, (0.1, 0.3, 0), (0, 1, 0)),
        "cone, tip": Probe(cone, (0, 0.7, 0), (0, 1, 0)),
    }
