"""What an agent sees of an object from a viewpoint, and the places where the sensor comes down."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.active.policies import PolicyView
from visuohaptic.active.sessions import policy_views
from visuohaptic.attention.model import attend
from visuohaptic.base.arrays import BoolArray, FloatArray
from visuohaptic.environment.settings import TouchSettings
from visuohaptic.fixations.places import nearest_places
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.parameters import VISUAL_EFFECTS, VisualModes
from visuohaptic.sensor.imprints import Poses
from visuohaptic.sensor.reaching import reachable
from visuohaptic.sensor.sensing import sensor_poses
from visuohaptic.tables.phases import SPARE


@dataclass(frozen=True, eq=False)
class Landing:
    """Places of the surface where n sensors come down, as a policy's choices do; lengths in object radii.

    Attributes
    ----------
    aims : ndarray of shape (n, 3)
        The points that were aimed at, object frame.
    points, normals : ndarray of shape (n, 3)
        The nearest points of the surface, and outward unit normals of their faces.
    poses : Poses
        The sensors.
    reached : ndarray of shape (n,), bool
        Whether the sensor can reach the place, or places out of reach are touched as well
        (``probing.unreachable: keep``).
    """

    aims: FloatArray
    points: FloatArray
    normals: FloatArray
    poses: Poses
    reached: BoolArray

    def take(self, rows: slice) -> Landing:
        """Return some of the places."""
        return Landing(
            self.aims[rows],
            self.points[rows],
            self.normals[rows],
            self.poses[rows],
            self.reached[rows],
        )


def land(caster: RayCaster, aims: FloatArray, parameters: ExperimentParameters) -> Landing:
    """Return where sensors come down that aim at points (n, 3), object frame; n is at least 1."""
    places, sensor = nearest_places(caster, aims), parameters.sensor
    where = (caster, places.points, places.normals, sensor, places.faces)
    reached = reachable(*where) | (parameters.probing.unreachable == "keep")
    return Landing(aims, places.points, places.normals, sensor_poses(*where), reached)


def join_poses(parts: Sequence[Poses]) -> Poses:
    """Concatenate poses; at least one part is needed."""
    names = ("points", "normals", "columns", "rows")
    return Poses(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


@dataclass(frozen=True, eq=False)
class Sight:
    """What is seen of an object from a viewpoint.

    Attributes
    ----------
    policy_view : PolicyView
        The surface and the camera.
    candidates : Landing, or None
        The k candidate places: the fixations, then places that are spread over the visible surface. None without any.
    index : ndarray of shape (k,), int64
        Index of each candidate among all candidates that an action may name; the others do not exist.
    pictures : mapping of str to ndarray
        Empty, or ``view`` (h, w, 3) and ``saliency`` (h, w, 1), both uint8, and ``fixations`` (f, 2), float32: their
        positions in the view, to the right and up, -1 to 1.
    """

    policy_view: PolicyView
    candidates: Landing | None
    index: NDArray[np.int64]
    pictures: Mapping[str, NDArray[Any]]


def look(view: PolicyView, settings: TouchSettings, parameters: ExperimentParameters) -> Sight:
    """Look at an object from a policy's view."""
    fixated, pictures = np.zeros((0, 3)), dict[str, NDArray[Any]]()
    if {"view", "saliency", "fixations"} & {*settings.sight}:
        fixated, pictures = _attend(view, parameters)
    if "fixations" not in settings.sight:
        fixated = fixated[:0]
    spread = view.places.points[: settings.places]
    aims = np.concatenate([fixated, spread])
    index = np.concatenate(
        [np.arange(len(fixated)), settings.fixations(parameters) + np.arange(len(spread))]
    )
    candidates = land(view.caster, aims, parameters) if len(aims) else None
    return Sight(view, candidates, index, pictures)


def _attend(
    view: PolicyView, parameters: ExperimentParameters
) -> tuple[FloatArray, dict[str, NDArray[Any]]]:
    """Render a view and return the fixated points (f, 3), and the pictures of `Sight`."""
    modes = VisualModes(
        **{name: getattr(parameters.scene.effects, name) for name in VISUAL_EFFECTS}
    )
    views = render_views(view.caster, [view.camera], parameters.rendering, modes)
    attention = parameters.attention
    [attended] = attend(
        **views.attend_arguments(),
        parameters=attention.model_copy(update={"fixations": attention.fixations + SPARE}),
    )
    path, resolution = attended.scanpath, parameters.rendering.resolution
    positions = (2 * np.column_stack([path.columns, path.rows]) + 1) / resolution - 1
    pictures = {
        "view": np.rint(255 * views.colour[0]).astype(np.uint8),
        "saliency": np.rint(255 * attended.saliency[:, :, None]).astype(np.uint8),
        "fixations": (positions * [1, -1]).astype(np.float32),
    }
    return path.points, pictures


def rays_through(camera: Camera, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return origins and directions (n, 3) of rays through positions (n, 2) in the view, to the right and up, -1 to 1."""
    half = 0.5 * camera.view_height / camera.distance
    plane = half * positions @ camera.axes[:2]
    if camera.projection == "orthographic":
        return camera.eye + camera.distance * plane, np.tile(-camera.axes[2], (len(plane), 1))
    return np.tile(camera.eye, (len(plane), 1)), plane - camera.axes[2]


@dataclass(frozen=True, eq=False)
class Body:
    """An object as it stands, with its viewpoints; surface, ray caster and sights are computed on first use and kept.

    Attributes
    ----------
    key : str
        The object, `class/name`.
    read : callable
        Returns the surface.
    settings : TouchSettings
        What is seen.
    parameters : ExperimentParameters
        Viewpoints, rendering, attention, sensor, scene and seed.
    """

    key: str
    read: Callable[[], Surface]
    settings: TouchSettings
    parameters: ExperimentParameters

    @cached_property
    def subject(self) -> Subject:
        """The object with all its viewpoints."""
        find_caster = lambda: RayCaster(self.read())  # noqa: E731
        return Subject(self.key, find_caster, range(self.parameters.viewpoints.total))

    @cached_property
    def _views(self) -> dict[int, PolicyView]:
        stream, parameters = self.settings.random_stream, self.parameters
        return policy_views(self.subject, stream, parameters.viewpoints, parameters.seed)

    @cached_property
    def _sights(self) -> dict[int, Sight]:
        return {}

    def sight(self, viewpoint: int) -> Sight:
        """Return the sight from a viewpoint."""
        if viewpoint not in self._sights:
            self._sights[viewpoint] = look(self._views[viewpoint], self.settings, self.parameters)
        return self._sights[viewpoint]
