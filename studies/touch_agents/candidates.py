"""Touch all candidate places of the environment once, so that agents are trained and tested on arrays.

From each viewpoint one environment per place makes the first touch of an episode. Objects do not move and their touches
have no noise, so a touch at a place is the same in every later step (`tests/studies/touch_agents`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from scipy.ndimage import distance_transform_edt, uniform_filter

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.environment import TouchVectorEnv
from visuohaptic.environment.objects import Objects
from visuohaptic.environment.sight import Sight
from visuohaptic.features.describing import describe_imprints
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.fixations.places import draw_by_area
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.tables.phases import (
    CONTACT_STATES,
    CONTOURLET_FEATURES,
    IMPRINT_FEATURES,
    KINESTHETIC_FEATURES,
    SPARE,
)

Setting = Literal["upright", "turned"]
"""``upright``: the whole pose is known. ``turned``: the object stands turned in any way, and its centre is known."""

Senses = Literal["seeing", "blind"]
SENSES: tuple[Senses, ...] = get_args(Senses)

FRAMES: dict[Setting, Frame] = {"upright": "full", "turned": "centre"}
"""What recognition knows of an object's frame."""

FEATURES = (
    *CONTOURLET_FEATURES,
    *KINESTHETIC_FEATURES,
    *IMPRINT_FEATURES,
    "sensor_size",
    *(f"contact_{state}" for state in CONTACT_STATES),
)
"""Features of a touch, as phase `features` computes them."""

VIEWPOINTS = 8
TURNS = 4
SPREAD = 24
"""Candidates that are spread over the visible surface, beside the fixations."""

DRAWN = 96
"""Places of the whole surface that are drawn per viewpoint; the first in reach are the candidates of a blind agent."""

GRID = 64
"""Rows and columns of the depth map from which outline and relief are computed."""


_Rows = tuple[FloatArray, FloatArray, FloatArray]
"""Touches, knowledge and anchors of the candidates from a viewpoint, as in `Candidates`."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """The k candidate places of n starts, an object from a viewpoint each; rows of fewer places are filled with 0.

    Attributes
    ----------
    touches : ndarray of shape (n, k, f)
        `FEATURES` of a touch at each place.
    known : ndarray of shape (n, k, m)
        Knowledge of an agent of each place before a touch.
    anchors : ndarray of shape (n, k, 3)
        Point of each place, object radii; without sight its direction from the object's centre.
    valid : ndarray of shape (n, k), bool
        Whether there is such a place, in reach.
    keys : tuple of str
        The objects, ``class/name``.
    owners : ndarray of shape (n,)
        Index in `keys` of each start.
    """

    touches: FloatArray
    known: FloatArray
    anchors: FloatArray
    valid: BoolArray
    keys: tuple[str, ...]
    owners: IntArray

    @property
    def classes(self) -> tuple[str, ...]:
        """The classes of the objects, sorted."""
        return tuple(sorted({key.partition("/")[0] for key in self.keys}))

    @property
    def labels(self) -> IntArray:
        """Index in `classes` of each start, shape (n,)."""
        of_object = [self.classes.index(key.partition("/")[0]) for key in self.keys]
        return np.array(of_object, dtype=np.int64)[self.owners]

    def starts_of(self, keys: Sequence[str]) -> IntArray:
        """Return the indices of the starts of some objects, ascending."""
        chosen = [index for index, key in enumerate(self.keys) if key in {*keys}]
        return np.flatnonzero(np.isin(self.owners, chosen))


def collect(
    objects: Objects,
    setting: Setting,
    parameters: ExperimentParameters,
    keys: Sequence[str] | None = None,
) -> dict[Senses, Candidates]:
    """Touch the candidates of objects from every viewpoint, for a seeing and for a blind agent.

    Both have the same starts, and as many candidates in each. `keys` are the objects, by default all in `objects`.
    """
    found: dict[Senses, list[_Rows]] = {name: [] for name in SENSES}
    names = list(keys or TouchVectorEnv(1, objects, "all", parameters).keys)
    for key in names:
        for seeing, blind in _of_object(objects, key, setting, parameters):
            found["seeing"].append(seeing)
            found["blind"].append(blind)
    owners = np.repeat(np.arange(len(names)), parameters.viewpoints.total)
    return {name: _pad(rows, names, owners) for name, rows in found.items()}


def _of_object(
    objects: Objects, key: str, setting: Setting, parameters: ExperimentParameters
) -> Iterator[tuple[_Rows, _Rows]]:
    """Yield touches, knowledge and anchors from each viewpoint, with sight and without."""
    count = SPREAD + parameters.attention.fixations + SPARE
    shared: dict[str, Any] = {"touches": 1, "turn_draws": TURNS}
    shared["turns"] = "any" if setting == "turned" else "none"
    seeing = TouchVectorEnv(count, objects, "all", parameters, places=SPREAD, **shared)
    blind = TouchVectorEnv(DRAWN, objects, "all", parameters, action="point", sight=(), **shared)
    total = parameters.viewpoints.total
    for viewpoint in range(total):
        turn = viewpoint * TURNS // total
        chosen = {"object": key, "viewpoint": viewpoint, "turn_draw": turn, "draw": 0}
        seen, _ = seeing.reset(seed=0, options=chosen)
        touched, features = touch_all(seeing, np.arange(count))
        sight = seeing.episodes[0].sight
        known = describe_places(sight, seen, parameters)
        # Places and their features are in the order of the environment's indices.
        points = seen["places"][0, :, :3].astype(np.float64)
        if setting == "upright":
            known = np.concatenate([known, seen["places"][0]], axis=1)
        blind.reset(seed=0, options=chosen)
        generator = spawn_generator(parameters.seed, "reach", key, viewpoint)
        surface = blind.episodes[0].body.subject.caster.surface
        drawn = draw_by_area(surface, DRAWN, generator).points
        in_reach, felt = touch_all(blind, drawn)
        chosen_rows = np.flatnonzero(in_reach)[: touched.sum()]
        directions = drawn / np.linalg.norm(drawn, axis=1, keepdims=True)
        told = directions if setting == "upright" else np.zeros((DRAWN, 0))
        yield (
            (features[touched], known[touched], points[touched]),
            (felt[chosen_rows], told[chosen_rows], directions[chosen_rows]),
        )


def touch_all(environment: TouchVectorEnv, actions: Any) -> tuple[BoolArray, FloatArray]:
    """Make one touch per row of an environment: return which rows made a touch (n,), and `FEATURES` (n, f)."""
    blind_guess = np.zeros((environment.num_envs, len(environment.classes)))
    seen, _, _, _, told = environment.step({"action": actions, "prediction": blind_guess})
    return told["touched"], features_of(seen, environment.parameters)


def features_of(seen: Any, parameters: ExperimentParameters) -> FloatArray:
    """Compute `FEATURES` (n, f) of the last touches in observations of n rows."""
    imprints = seen["imprint"]
    bands = describe_imprints(imprints, parameters.features)
    contact = seen["contact"][:, None] == 1 + np.arange(len(CONTACT_STATES))
    parts = [bands, seen["pose"][:, :6], describe_imprint_shape(imprints), seen["size"][:, None]]
    return np.concatenate([*parts, contact], axis=1).astype(np.float64)


def describe_places(sight: Sight, seen: Any, parameters: ExperimentParameters) -> FloatArray:
    """Describe how each candidate place looks in the first row of observations `seen`: (k, m).

    Position in the view, depth, cosine of the angle between normal and line of sight, normal in the camera's axes,
    distance from the centre; saliency there and around; distance from the outline, fold and unevenness of the depth map
    there; rank among the fixations; width, height and area of the outline; cosine of the angle between normal and
    direction from the centre.
    """
    camera, caster = sight.policy_view.camera, sight.policy_view.caster
    points, normals = np.split(seen["places"][0].astype(np.float64), 2, axis=1)
    hits = caster.first_hits(*camera.rays(GRID))
    hit = hits.hit.reshape(GRID, GRID)
    depth = np.where(hit, hits.distance.reshape(GRID, GRID), np.nan)
    position = camera.project(points, GRID)
    column, row = np.clip(position.astype(np.int64), 0, GRID - 1).T
    offset, radii = camera.eye - points, np.linalg.norm(points, axis=1)
    depth_of_place = np.linalg.norm(offset, axis=1)
    facing = (normals * offset).sum(axis=1) / depth_of_place
    saliency = seen["saliency"][0, :, :, 0] / 255
    pixels = parameters.rendering.resolution
    across, down = np.clip(camera.project(points, pixels).astype(np.int64), 0, pixels - 1).T
    around = uniform_filter(saliency, pixels // 16)
    shape = _relief(depth, hit)
    rows, columns = np.flatnonzero(hit.any(axis=1)), np.flatnonzero(hit.any(axis=0))
    fixations = parameters.attention.fixations + SPARE
    rank = np.minimum(np.arange(len(points)), fixations) / fixations
    outline = [np.ptp(rows) / GRID, np.ptp(columns) / GRID, hit.mean()]
    return np.column_stack(
        [
            2 * position / GRID - 1,
            depth_of_place,
            facing,
            normals @ camera.axes.T,
            radii,
            saliency[down, across],
            around[down, across],
            *(each[row, column] for each in shape),
            rank,
            np.tile(outline, (len(points), 1)),
            (normals * points).sum(axis=1) / np.maximum(radii, 1e-9),
        ]
    )


def _relief(depth: FloatArray, hit: BoolArray) -> list[FloatArray]:
    """Compute distance from the outline (radii of the view), fold and unevenness of a depth map (g, g)."""
    share = np.maximum(uniform_filter(hit.astype(np.float64), 5), 1e-9)
    filled = np.where(hit, depth, 0.0)
    mean = uniform_filter(filled, 5) / share
    square = uniform_filter(filled**2, 5) / share
    return [
        2 * distance_transform_edt(hit) / len(hit),
        np.where(hit, filled - mean, 0.0),
        np.sqrt(np.maximum(square - mean**2, 0.0)),
    ]


def _pad(
    rows: Sequence[_Rows],
    keys: Sequence[str],
    owners: IntArray,
) -> Candidates:
    most = max(len(row[0]) for row in rows)
    touches, known, anchors = (
        np.stack([np.pad(row[part], ((0, most - len(row[part])), (0, 0))) for row in rows])
        for part in range(3)
    )
    valid = np.array([np.arange(most) < len(row[0]) for row in rows])
    return Candidates(touches, known, anchors, valid, tuple(keys), owners)


def save_candidates(candidates: Mapping[Senses, Candidates], seconds: float, path: Path) -> None:
    """Write candidates, and the processor seconds of `collect`, to an ``.npz`` file. Missing folders are created."""
    parts: dict[str, Any] = {
        f"{senses} {field.name}": np.asarray(getattr(own, field.name))
        for senses, own in candidates.items()
        for field in fields(own)
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file(path) as unfinished, unfinished.open("wb") as stream:
        np.savez_compressed(stream, seconds=seconds, **parts)


def load_candidates(path: Path) -> tuple[dict[Senses, Candidates], float]:
    """Read candidates and seconds that `save_candidates` wrote."""
    with np.load(path) as parts:
        seconds = float(parts["seconds"])
        found = {
            senses: {field.name: parts[f"{senses} {field.name}"] for field in fields(Candidates)}
            for senses in SENSES
        }
    for own in found.values():
        own["keys"] = tuple(own["keys"].tolist())
    return {senses: Candidates(**own) for senses, own in found.items()}, seconds
