"""Small shapes that are hard to touch, to show the limits of the sensor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.sensing import Touches, touch

Height = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True)
class HardProbe:
    """An object with a point to touch and the outward normal there, object frame."""

    name: str
    surface: Surface
    point: tuple[float, float, float]
    normal: tuple[float, float, float]


def touch_gallery(
    parameters: SensorParameters, scene: Scene, seed: int = 0
) -> list[tuple[HardProbe, Touches]]:
    """Touch every hard probe once."""
    return [
        (
            probe,
            touch(
                RayCaster(probe.surface),
                np.array([probe.point]),
                np.array([probe.normal]),
                parameters,
                scene,
                RandomFields(seed, [("gallery", probe.name)]),
            ),
        )
        for probe in hard_probes()
    ]


def hard_probes() -> tuple[HardProbe, ...]:
    """Return the hard probes, inside the unit sphere: bowl, screw thread, cup, leaf, knife and cone."""
    thread, cup, leaf = _screw(), _cup(), _leaf()
    slope = 1 / np.hypot(0.45, 1)
    rim_height = float(0.15 * np.sin(1.2) + 0.05)
    return (
        HardProbe("bowl, inside", _bowl(), (0, -0.6, 0), (0, 1, 0)),
        HardProbe("screw thread, groove", thread, (0.2, 0.0625, 0), (1, 0, 0)),
        HardProbe("screw thread, crest", thread, (0.23, 0, 0), (1, 0, 0)),
        HardProbe("cup, inner wall", cup, (0.37, 0.1, 0), (-1, 0, 0)),
        HardProbe("cup, floor", cup, (0.2, -0.47, 0), (0, 1, 0)),
        HardProbe("cup, handle", cup, (0.74, 0, 0), (1, 0, 0)),
        HardProbe("cup, under the handle", cup, (0.66, 0, 0), (-1, 0, 0)),
        HardProbe("leaf", leaf, (0, 0.05, 0), (-0.45 * slope, slope, 0)),
        HardProbe("leaf, rim", leaf, (0.4, rim_height, 0), (0, 1, 0)),
        HardProbe("knife edge", _knife(), (0.1, 0.3, 0), (0, 1, 0)),
        HardProbe("cone, tip", revolve([0, 0.5, 0], [-0.5, -0.5, 0.7]), (0, 0.7, 0), (0, 1, 0)),
    )


def sheet(height: Height, half: float = 0.5, cells: int = 200) -> Surface:
    """Return the graph y = height(x, z) over a square as an open sheet, wound counter-clockwise from above.

    The square has the edge 2 `half` and `cells` cells along each edge. Each cell has two triangles, divided along its
    (+x, +z) diagonal.
    """
    along = np.linspace(-half, half, cells + 1)
    x, z = np.meshgrid(along, along, indexing="ij")
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    return build_surface(np.stack([x, height(x, z), z], axis=-1), _split_quads(a, d, c, b))


def revolve(radii: ArrayLike, heights: ArrayLike, segments: int = 96) -> Surface:
    """Return the surface of revolution of a profile (k,) around the y axis; radius 0 closes an end."""
    angles = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.zeros(segments), np.sin(angles)])
    radii, heights = np.asarray(radii, dtype=float), np.asarray(heights, dtype=float)
    vertices = radii[:, None, None] * ring + heights[:, None, None] * np.array([0, 1, 0])
    surface = build_surface(vertices, _wrap_rings(len(radii), segments))
    return build_surface(surface.vertices, surface.faces[surface.face_areas > 1e-14])


def tube(path: ArrayLike, radius: float, sides: int = 24) -> Surface:
    """Return a round tube along a path (k, 3) with open ends."""
    path = np.asarray(path, dtype=float)
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along, [0.3, 0.2, 1.0])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    angles = np.linspace(0, 2 * np.pi, sides, endpoint=False)[:, None]
    around = np.cos(angles) * side[:, None] + np.sin(angles) * np.cross(along, side)[:, None]
    return build_surface(path[:, None] + radius * around, _wrap_rings(len(path), sides))


def join(*surfaces: Surface) -> Surface:
    """Concatenate surfaces without merging vertices."""
    starts = np.cumsum([0, *(len(surface.vertices) for surface in surfaces[:-1])])
    return build_surface(
        np.concatenate([surface.vertices for surface in surfaces]),
        np.concatenate(
            [surface.faces + start for surface, start in zip(surfaces, starts, strict=True)]
        ),
    )


def build_surface(vertices: ArrayLike, faces: ArrayLike) -> Surface:
    """Return a grey surface from vertices (…, 3) and faces (f, 3)."""
    faces = np.asarray(faces, dtype=np.int64).reshape(-1, 3)
    vertices = np.asarray(vertices, dtype=np.float64).reshape(-1, 3)
    return Surface(vertices, faces, np.full((len(faces), 3), 128, dtype=np.uint8))


def _split_quads(*corners: IntArray) -> IntArray:
    a, b, c, d = (corner.reshape(-1) for corner in corners)
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _wrap_rings(rings: int, steps: int) -> IntArray:
    index = np.arange(rings * steps).reshape(rings, steps)
    beside = np.roll(index, -1, axis=1)
    return _split_quads(index[:-1], index[1:], beside[1:], beside[:-1])


def _bowl() -> Surface:
    angle = np.linspace(0, np.pi / 2, 60)
    return revolve(
        np.concatenate([0.6 * np.sin(angle), 0.63 * np.sin(angle[::-1])]),
        np.concatenate([-0.6 * np.cos(angle), -0.63 * np.cos(angle[::-1])]),
    )


def _screw() -> Surface:
    turns = np.linspace(0, 16 * np.pi, 600)
    helix = np.column_stack([0.2 * np.cos(turns), turns / turns[-1] - 0.5, 0.2 * np.sin(turns)])
    return join(revolve([0, 0.2, 0.2, 0], [-0.6, -0.6, 0.6, 0.6]), tube(helix, 0.03))


def _cup() -> Surface:
    angle = np.linspace(-np.pi / 2, np.pi / 2, 40)
    handle = np.column_stack([0.4 + 0.3 * np.cos(angle), 0.3 * np.sin(angle), 0 * angle])
    body = revolve([0, 0.4, 0.4, 0.37, 0.37, 0], [-0.5, -0.5, 0.5, 0.5, -0.47, -0.47])
    return join(body, tube(handle, 0.04))


def _leaf() -> Surface:
    return sheet(lambda x, z: 0.15 * np.sin(3 * x) + 0.05 * np.cos(9 * z), half=0.4, cells=60)


def _knife() -> Surface:
    back = [[-0.8, -0.3, 0.04], [0.8, -0.3, 0.04], [0.8, -0.3, -0.04], [-0.8, -0.3, -0.04]]
    faces = [[0, 1, 5], [0, 5, 4], [2, 3, 4], [2, 4, 5], [0, 4, 3], [1, 2, 5], [0, 3, 2], [0, 2, 1]]
    return build_surface([*back, [-0.8, 0.3, 0], [0.8, 0.3, 0]], faces)
