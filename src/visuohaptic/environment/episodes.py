"""One episode: an object from a viewpoint, the tries so far, and the observation of an agent."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.active.policies import MAX_SURFACE_DISTANCE, Felt
from visuohaptic.active.sessions import SAME_LOCATION
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.environment.settings import TouchSettings
from visuohaptic.environment.sight import Body, Landing, Sight, rays_through
from visuohaptic.geometry.turning import Turns, draw_rotation
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.sensor.frames import column_axes, row_axes
from visuohaptic.sensor.imprints import Poses
from visuohaptic.tables.phases import CONTACT_STATES

Observation = dict[str, NDArray[Any]]

_TURNS_OF_FRAME: Mapping[Frame, Turns] = {"vertical": "vertical", "centre": "any", "none": "any"}


@dataclass(frozen=True, eq=False)
class KnownFrame:
    """The frame of an agent's coordinates: x ↦ rotation · x + shift of the object frame; None is the identity."""

    rotation: FloatArray | None = None
    shift: FloatArray | float = 0.0

    def vectors(self, vectors: FloatArray) -> FloatArray:
        """Rotate vectors (..., 3) into the frame."""
        return vectors if self.rotation is None else vectors @ self.rotation.T

    def points(self, points: FloatArray) -> FloatArray:
        """Transform points (..., 3) into the frame."""
        return points if self.rotation is None else self.vectors(points) + self.shift

    def back(self, points: FloatArray) -> FloatArray:
        """Transform points (..., 3) of the frame into the object frame."""
        return points if self.rotation is None else (points - self.shift) @ self.rotation

    def orient(self, poses: Poses, parameters: ExperimentParameters) -> Poses:
        """Turn sensors about their normals, so that they are upright in the frame."""
        if self.rotation is None:
            return poses
        columns = column_axes(self.vectors(poses.normals), parameters.sensor.orientation)
        columns = columns @ self.rotation
        return Poses(poses.points, poses.normals, columns, row_axes(poses.normals, columns))


def draw_frame(frame: Frame, generator: np.random.Generator) -> KnownFrame:
    """Draw the frame of an episode; `generator` is that of a policy's view, which an agent in the experiment has too."""
    if frame == "full":
        return KnownFrame()
    rotation = draw_rotation(_TURNS_OF_FRAME[frame], "frame", int(generator.integers(2**31)))
    if frame != "none":
        return KnownFrame(rotation)
    return KnownFrame(rotation, generator.uniform(-1.0, 1.0, 3))


@dataclass(eq=False)
class Episode:
    """The state of an episode.

    Attributes
    ----------
    body : Body
        The object.
    viewpoint : int
        The number of the viewpoint.
    sight : Sight
        What is seen from there.
    random_stream : str
        Name from which the noise of the episode is seeded.
    frame : KnownFrame
        The frame of the agent's coordinates.
    settings : TouchSettings
        What is observed.
    felt : list of Felt
        The tries at places of the surface, as a policy is told.
    made : int
        The number of touches among them.
    tried : int
        The number of all tries, also beside the object.
    last : Felt, optional
        The last try if it was a touch.
    offset : ndarray of shape (3,)
        The shift of the object by its touches so far, object frame.
    seen_at : ndarray of shape (3,)
        The shift of the object before the last touch.
    """

    body: Body
    viewpoint: int
    sight: Sight
    random_stream: str
    frame: KnownFrame
    settings: TouchSettings
    felt: list[Felt] = field(default_factory=list)
    made: int = 0
    tried: int = 0
    last: Felt | None = None
    offset: FloatArray = field(default_factory=lambda: np.zeros(3))
    seen_at: FloatArray = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        """Mark the candidates that the sensor can touch."""
        parameters, settings = self.body.parameters, self.settings
        self.valid = np.zeros(settings.candidates(parameters) + 1, dtype=np.int8)
        # The index after the candidates ends the episode.
        self.valid[-1] = 1
        if self.sight.candidates is not None:
            self.valid[self.sight.index] = self.sight.candidates.reached
        self._moves = spawn_generator(
            parameters.seed, "moves", self.random_stream, self.body.key, self.viewpoint
        )

    @property
    def random_key(self) -> tuple[object, ...]:
        """The key of the next touch for `RandomFields`, as `PolicySession.random_key`."""
        return (*self.body.key.split("/"), self.viewpoint, self.random_stream, self.made)

    @property
    def complete(self) -> bool:
        """Whether all tries of the episode are made, so that the next prediction ends it."""
        return self.tried >= self.settings.touches

    @property
    def tells_columns(self) -> bool:
        """Whether the sensor is upright in the agent's frame, so that the axis of its columns tells no turn."""
        return self.settings.upright == "frame" or self.settings.frame == "full"

    def sensors(self, poses: Poses) -> Poses:
        """Return the sensors that touch at poses which are upright in the object frame."""
        return self.frame.orient(poses, self.body.parameters) if self.tells_columns else poses

    def candidate(self, index: int) -> Landing | None:
        """Return the candidate place at an index; None if there is none."""
        places = self.sight.candidates
        row = int(np.searchsorted(self.sight.index, index))
        if places is None or row == len(self.sight.index) or self.sight.index[row] != index:
            return None
        return places.take(slice(row, row + 1))

    def aim(self, choice: FloatArray) -> FloatArray | None:
        """Return the point (1, 3), object frame, that a direction (2,) or point (3,) aims at; None beside the object."""
        if self.settings.action == "object_point":
            return choice[None] - self.offset
        if self.settings.action == "point":
            return self.frame.back(choice)[None] - self.offset
        view = self.sight.policy_view
        origins, directions = rays_through(view.camera, choice[None])
        hits = view.caster.first_hits(origins - self.offset, directions)
        if not hits.hit[0]:
            return None
        return origins - self.offset + hits.distance[:, None] * directions

    def refuses(self, place: Landing) -> bool:
        """Return whether a place (of one row) is too far from its aim, or was tried before."""
        point = place.points[0]
        if np.linalg.norm(place.aims[0] - point) > MAX_SURFACE_DISTANCE:
            return True
        return any(np.linalg.norm(one.point - point) <= SAME_LOCATION for one in self.felt)

    def add(self, felt: Felt | None) -> None:
        """Record a try; None is a try beside the object, or at a place that was tried before."""
        self.tried += 1
        self.last = None
        if felt is None:
            return
        self.felt.append(felt)
        places = self.sight.candidates
        if places is not None:
            near = np.linalg.norm(places.points - felt.point, axis=1) <= SAME_LOCATION
            self.valid[self.sight.index[near]] = 0
        if felt.imprint is None:
            return
        self.last, self.seen_at = felt, self.offset
        self.made += 1
        if self.settings.noise:
            self.offset = self.offset + self.settings.noise * self._moves.uniform(-1.0, 1.0, 3)

    def observe(self) -> Observation:
        """Return the observation of the last touch; without a touch its entries are 0."""
        sensor, felt = self.body.parameters.sensor, self.last
        pose, resolution = np.zeros(9, dtype=np.float32), sensor.resolution
        if felt is not None:
            normals = self.frame.vectors(felt.normal[None])
            pose[:3] = self.frame.points(felt.point + self.seen_at)
            pose[3:6] = normals[0]
            if self.tells_columns:
                pose[6:] = column_axes(normals, sensor.orientation)[0]
        seen: Observation = {
            "imprint": np.zeros((resolution, resolution), np.float32)
            if felt is None or felt.imprint is None
            else felt.imprint,
            "pose": pose,
            "size": np.array(0.0 if felt is None else felt.sensor_size, dtype=np.float32),
            "contact": np.array(
                0 if felt is None else 1 + CONTACT_STATES.index(str(felt.contact_state))
            ),
            "time_step": np.array(2 * self.tried / self.settings.touches - 1, dtype=np.float32),
        }
        if self.settings.action == "place":
            seen["valid"] = self.valid.copy()
        return seen

    def observe_sight(self) -> Observation:
        """Return the parts of the observation that stay the same in an episode."""
        seen: Observation = {}
        parameters, names = self.body.parameters, self.settings.sight
        for name, picture in self.sight.pictures.items():
            if name in names:
                seen[name] = picture
        if "fixations" in names:
            seen["fixations"] = _padded(seen["fixations"], self.settings.fixations(parameters))
        if "places" in names:
            places = np.zeros((self.settings.candidates(parameters), 6), dtype=np.float32)
            if self.sight.candidates is not None:
                landed = self.sight.candidates
                places[self.sight.index, :3] = self.frame.points(landed.points)
                places[self.sight.index, 3:] = self.frame.vectors(landed.poses.normals)
            seen["places"] = places
        return seen


def _padded(rows: NDArray[Any], count: int) -> NDArray[Any]:
    """Add rows of zeros to an array (n, k) up to `count` rows."""
    return np.concatenate([rows, np.zeros((count - len(rows), rows.shape[1]), rows.dtype)])
