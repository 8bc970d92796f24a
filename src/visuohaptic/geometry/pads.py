"""Layouts of published pads."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ParameterError
from visuohaptic.geometry.layouts import Layout, build_layout, grid_layout

_RINGS = 6
"""Rings of the TacTip's pins: 1 + 6 + 12 + … + 36 = 127 (B. Ward-Cherrier et al., Soft Robotics 5(2), 2018)."""

_DOME_RADIUS_M = 0.02
"""Radius of the TacTip's dome, which is 40 mm wide (the same)."""

_OUTER_RING_DEGREES = 75.0
"""Polar angle of the outermost ring of the dome. Our choice: the pins reach almost to the dome's rim."""

_FINGER_RADIUS_M = 0.007
"""Radius of the BioTac's skin around its axis (C.-H. Lin et al., SynTouch 2013)."""

_FINGER_HALF_LENGTH_M = 0.01
_FINGER_ARC_DEGREES = 60.0
"""Half the angle around the axis that has taxels. Our choice, as are length and number of taxels."""

_OPENING_M = 0.085
"""Stroke of the gripper Robotiq 2F-85."""

_CELL_M = 0.0055
"""Edge of a taxel of Robotiq's tactile fingertip TSF-85: 4 x 7 taxels, the 4 over the 22 mm of the finger."""

_AWAY = np.array([0.0, 0.0, 1.0])


def _round() -> Layout:
    """Return the rings of the TacTip in a plane: a round flat pad, 40 mm wide, with 127 taxels."""
    radii, angles = _rings()
    flat = radii / (_RINGS + 0.5)
    positions = np.stack([flat * np.cos(angles), flat * np.sin(angles), 0 * flat], axis=1)
    return build_layout("round", positions, _axial(len(positions)), _DOME_RADIUS_M, (1.0, 1.0))


def _dome() -> Layout:
    """Return a spherical fingertip: the dome of the TacTip, 40 mm wide, with 127 taxels on 6 rings."""
    rings, angles = _rings()
    polar = np.radians(_OUTER_RING_DEGREES) * rings / _RINGS
    outwards = np.stack(
        [np.sin(polar) * np.cos(angles), np.sin(polar) * np.sin(angles), -np.cos(polar)], axis=1
    )
    return build_layout("dome", outwards + _AWAY, outwards, _DOME_RADIUS_M, (1.0, 1.0))


def _finger() -> Layout:
    """Return a cylindrical fingertip of the BioTac's radius: 9 taxels around its axis y and 11 along the axis."""
    angles = np.radians(np.linspace(-_FINGER_ARC_DEGREES, _FINGER_ARC_DEGREES, 9))
    along, around = np.meshgrid(np.linspace(1, -1, 11), angles, indexing="ij")
    zero = np.zeros_like(around)
    outwards = np.stack([np.sin(around), zero, -np.cos(around)], axis=-1).reshape(-1, 3)
    radius = _FINGER_RADIUS_M / _FINGER_HALF_LENGTH_M
    positions = radius * (outwards + _AWAY)
    positions[:, 1] = along.ravel()
    return build_layout("finger", positions, outwards, _FINGER_HALF_LENGTH_M)


def _gripper() -> Layout:
    """Return two flat pads of 4 x 7 taxels that face each other; their tips are in the plane z = 0."""
    half = _OPENING_M / 2
    along, away = np.meshgrid(
        _CELL_M * (np.arange(4) - 1.5), _CELL_M * (np.arange(7) + 0.5), indexing="ij"
    )
    sides = [
        np.stack([np.full(28, side * half), along.ravel(), away.ravel()], axis=1)
        for side in (-1, 1)
    ]
    directions = np.repeat([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], 28, axis=0)
    return build_layout("gripper", np.concatenate(sides) / half, directions, half)


def _rings() -> tuple[FloatArray, FloatArray]:
    """Return ring number and angle (127,) of each pin: ring i has 6 i pins at equal steps."""
    rings = [(ring, 2 * np.pi * pin / (6 * ring)) for ring in range(1, _RINGS + 1) for pin in range(6 * ring)]  # fmt: skip
    numbers, angles = np.array([(0, 0.0), *rings]).T
    return numbers, angles


def _axial(count: int) -> FloatArray:
    return np.tile([0.0, 0.0, -1.0], (count, 1))


_PADS: dict[str, Callable[[], Layout]] = {
    "round": _round,
    "dome": _dome,
    "finger": _finger,
    "gripper": _gripper,
}

PADS = ("square", *_PADS)
"""Names of layouts; the square is a grid of any resolution (`grid_layout`)."""


Taxels = tuple[tuple[float, float, float, float, float, float], ...]
"""Position x, y, z and direction x, y, z of each taxel."""


@lru_cache(maxsize=64)
def layout_of(layout: str | Taxels, resolution: int) -> Layout:
    """Return the layout that a parameter names or holds; `resolution` is that of the square.

    Raises `ParameterError` if no layout has the name, or the taxels are not allowed.
    """
    if not isinstance(layout, str):
        rows = np.array(layout, dtype=np.float64).reshape(len(layout), 6)
        return Layout.of(rows[:, :3], rows[:, 3:])
    if layout == "square":
        return grid_layout(resolution, resolution)
    if layout not in _PADS:
        raise ParameterError(
            f"{layout!r} is no layout; {', '.join(PADS)}, or a CSV file is allowed."
        )
    return _PADS[layout]()
