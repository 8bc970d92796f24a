"""The vector environment: a step touches the objects of all episodes in one batch per object."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.spaces import Box, Dict, Discrete, MultiBinary
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from visuohaptic.active.policies import FARTHEST_POINT
from visuohaptic.active.sessions import felt_nothing, felt_touch
from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.draw_names import DRAW_MARK
from visuohaptic.base.errors import ParameterError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.environment.episodes import Episode, Observation, draw_frame
from visuohaptic.environment.objects import (
    Objects,
    Split,
    class_of,
    classes_of,
    objects_of_split,
    surfaces_of,
)
from visuohaptic.environment.settings import TouchSettings
from visuohaptic.environment.sight import Body, Landing, join_poses, land
from visuohaptic.geometry.turning import draw_rotation, turn_surface
from visuohaptic.parameters import ExperimentParameters, as_parameters
from visuohaptic.sensor.placing import place_batch
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.sensing import Touches, batches, sense
from visuohaptic.tables.phases import CONTACT_STATES

MISS_COST = 0.1
"""Part of the reward that a try costs in addition if it makes no touch."""

BODIES = 128
"""Objects, in one turn each, that are kept ready for touches; with all 16 views one takes some 5 MB and its mesh."""

DRAWS = 999_999
"""Number of different seeds of an episode's noise and frame."""


class CrossEntropy:
    """Cross entropy of logits, divided by that of a blind guess: `ap_gym.CrossEntropyLossFn(classes).normalized`."""

    def __init__(self, classes: int) -> None:
        self.classes = classes

    def numpy(
        self,
        prediction: ArrayLike,
        target: ArrayLike,
        batch_shape: tuple[int, ...] = (),  # noqa: ARG002 - as in ap_gym
    ) -> FloatArray:
        """Compute the losses (...) of logits (..., k) for true classes (...); `batch_shape` is not needed."""
        logits = np.asarray(prediction, dtype=np.float64)
        logits = logits - logits.max(axis=-1, keepdims=True)
        right = np.take_along_axis(logits, np.asarray(target)[..., None], axis=-1)[..., 0]
        return (np.log(np.exp(logits).sum(axis=-1)) - right) / np.log(self.classes)

    __call__ = numpy


class TouchVectorEnv(VectorEnv[Observation, Any, NDArray[Any]]):
    """Episodes in which an agent looks at an object, touches it place by place, and predicts its class.

    An action is a dict with ``action``, as setting `action` says, and ``prediction``, the logits of `classes` from all
    that was observed before. The reward is minus the loss of the prediction, minus `touch_cost` for a touch, and minus
    `MISS_COST` for a try without a touch: at a place out of reach, at a place that was tried before, or beside the
    object. After the last touch, a step only predicts and ends the episode. The index after the candidate places ends
    an episode earlier; its prediction then counts for the remaining steps too. The step after the end of an episode
    starts the next episode, and its action is ignored.

    Row i with seed s is a `TouchEnv` with seed s + i, bit for bit.

    Parameters
    ----------
    num_envs : int
        Number of episodes at a time.
    objects : path or sequence of TouchableObject, optional
        Folder of the meshes of a run, such as ``results/meshes``, or objects. The default is the package's examples.
    split : {"train", "validation", "test", "all"}
        The objects that are touched, by whole objects (`objects_of_split`).
    parameters : ExperimentParameters or mapping, optional
        Sections viewpoints, rendering, attention, sensor and scene, `seed`, and `probing.unreachable`.
    **settings
        Fields of `TouchSettings`.

    Attributes
    ----------
    classes : tuple of str
        Classes of all objects, of every split.
    keys : list of str
        The objects of the split, `class/name`.
    episodes : list of Episode
        The state of each row.
    numbers : ndarray of shape (n,), int64
        Number of the current episode of each row since the environment was made.
    loss_fn : CrossEntropy
        The loss of predictions.

    Raises
    ------
    ParameterError
        If an argument, a setting or an action is not allowed. An environment with a refused action stays as it was.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - as Gymnasium declares it
        "render_modes": [],
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        objects: Objects = None,
        split: Split = "train",
        parameters: ExperimentParameters | Mapping[str, Any] | None = None,
        *,
        render_mode: None = None,
        **settings: Any,
    ) -> None:
        if isinstance(num_envs, bool) or not isinstance(num_envs, int) or num_envs < 1:
            raise ParameterError(
                f"num_envs is {num_envs!r}; a whole number of at least 1 is needed."
            )
        if render_mode is not None:
            raise ParameterError(f"render_mode is {render_mode!r}; only None is allowed.")
        self._arguments = (num_envs, objects, split, parameters, settings)
        self.num_envs = num_envs
        self.settings = TouchSettings.checked(settings)
        self.parameters = as_parameters(parameters)
        self._surfaces = surfaces_of(objects)
        self.classes = classes_of(self._surfaces)
        self.keys = objects_of_split(self._surfaces, split, self.parameters.seed)
        self.loss_fn = CrossEntropy(len(self.classes))
        self._body = lru_cache(BODIES)(self._make_body)
        self.single_prediction_target_space = Discrete(len(self.classes))
        self.prediction_target_space = batch_space(self.single_prediction_target_space, num_envs)
        self.single_observation_space = self._observation_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.single_inner_action_space = self._inner_space()
        self.single_prediction_space = Box(-np.inf, np.inf, (len(self.classes),))
        self.single_action_space = Dict(
            {
                "action": self.single_inner_action_space,
                "prediction": self.single_prediction_space,
            }
        )
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.inner_action_space = batch_space(self.single_inner_action_space, num_envs)
        self.prediction_space = batch_space(self.single_prediction_space, num_envs)
        self.episodes: list[Episode] = []
        self.numbers = np.zeros(num_envs, dtype=np.int64)
        self.generators: list[np.random.Generator] = []
        self._ended = np.zeros(num_envs, dtype=bool)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the arguments: a copy is a new environment with these arguments."""
        *arguments, settings = self._arguments
        return _make, (type(self), tuple(arguments), settings)

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode in every row.

        Parameters
        ----------
        seed : int, optional
            Row i draws its episodes from seed + i.
        options : mapping, optional
            ``object`` (`class/name`), ``viewpoint``, ``turn_draw`` and ``draw`` of the episodes, instead of drawn
            values: a value for all rows, or a sequence with a value per row. With ``draw`` 0 noise and places are
            those of a strategy with the name `random_stream` in the experiment.

        Returns
        -------
        observation, info : dict
            ``info`` has the ``object`` and the ``viewpoint`` of each row.
        """
        self._check_open()
        chosen = self._chosen(options or {})
        if seed is not None or not self.generators:
            super().reset(seed=seed)
            seeds = (
                range(seed, seed + self.num_envs) if seed is not None else [None] * self.num_envs
            )
            self.generators = [np.random.default_rng(one) for one in seeds]
        rows = range(self.num_envs)
        self.episodes = [self._start(row, chosen[row]) for row in rows]
        self._ended[:] = False
        self._look(rows)
        return self._observe(), {
            "object": np.array([one.body.key for one in self.episodes]),
            "viewpoint": np.array([one.viewpoint for one in self.episodes]),
        }

    def step(
        self, actions: Mapping[str, ArrayLike]
    ) -> tuple[Observation, FloatArray, BoolArray, BoolArray, dict[str, Any]]:
        """Touch an object in every row, and score the predictions from what was observed before.

        ``info`` has ``base_reward`` (the reward without the loss), ``prediction`` with ``target`` and ``loss``, and
        ``touched``, whether the step made a touch.
        """
        self._check_open()
        if not self.episodes:
            raise ResetNeeded("step is called before reset; call reset first.")
        choices, predictions = self._read(actions)
        restarted, episodes = self._ended, self.episodes
        targets = np.array([self.classes.index(class_of(one.body.key)) for one in episodes])
        losses = np.where(restarted, 0.0, self.loss_fn(predictions, targets))
        ended = np.array([one.complete for one in episodes]) & ~restarted
        if self.settings.action == "place":
            ended |= ~restarted & (choices == self.settings.candidates(self.parameters))
        left = np.array([self.settings.touches + 1 - one.tried for one in episodes])
        trying = np.flatnonzero(~restarted & ~ended)
        base, touched = np.zeros(self.num_envs), np.zeros(self.num_envs, dtype=bool)
        touched[trying] = self._try(trying, choices)
        base[trying] = 0.0 - self.settings.touch_cost - MISS_COST * ~touched[trying]
        if restarted.any():
            rows = np.flatnonzero(restarted).tolist()
            for row in rows:
                episodes[row] = self._start(row, {})
            self._look(rows)
        self._ended = ended
        rewards = base - losses * np.where(ended, left, 1)
        info = {
            "base_reward": base,
            "prediction": {"target": targets, "loss": losses},
            "touched": touched,
        }
        return self._observe(), rewards, ended, np.zeros(self.num_envs, dtype=bool), info

    def close_extras(self, **_: Any) -> None:
        """Forget all objects."""
        self._body.cache_clear()
        self.episodes = []

    def _check_open(self) -> None:
        if self.closed:
            raise ClosedEnvironmentError("The environment is closed; make a new one.")

    def _make_body(self, key: str, turn_draw: int) -> Body:
        read, turns, seed = self._surfaces[key], self.settings.turns, self.parameters.seed
        if turns == "none":
            return Body(key, read, self.settings, self.parameters)
        rotation = draw_rotation(turns, key, seed, turn_draw)
        return Body(key, lambda: turn_surface(read(), rotation), self.settings, self.parameters)

    def _start(self, row: int, chosen: Mapping[str, Any]) -> Episode:
        """Draw the next episode of a row; values of `chosen` replace drawn values."""
        generator, turns = self.generators[row], self.settings.turns
        drawn = {
            "object": self.keys[generator.integers(len(self.keys))],
            "viewpoint": int(generator.integers(self.parameters.viewpoints.total)),
            "turn_draw": int(generator.integers(self.settings.turn_draws)),
            "draw": int(generator.integers(1, DRAWS + 1)),
            **chosen,
        }
        key, viewpoint, draw = drawn["object"], drawn["viewpoint"], drawn["draw"]
        stream = self.settings.random_stream + (f"{DRAW_MARK}{draw}" if draw else "")
        body = self._body(key, 0 if turns == "none" else drawn["turn_draw"])
        of_view = spawn_generator(self.parameters.seed, stream, key, viewpoint)
        frame = draw_frame(self.settings.frame, of_view)
        self.numbers[row] += 1
        return Episode(body, viewpoint, body.sight(viewpoint), stream, frame, self.settings)

    def _chosen(self, options: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Return the options of each row; raise `ParameterError` if one is not allowed."""
        allowed: dict[str, Sequence[Any]] = {
            "object": self.keys,
            "viewpoint": range(self.parameters.viewpoints.total),
            "turn_draw": range(self.settings.turn_draws),
            "draw": range(DRAWS + 1),
        }
        chosen: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for name, given in options.items():
            if name not in allowed:
                raise ParameterError(f"options has {name!r}; {', '.join(allowed)} are allowed.")
            values = [given] * self.num_envs if np.ndim(given) == 0 else list(given)
            if len(values) != self.num_envs:
                raise ParameterError(
                    f"options[{name!r}] has {len(values)} values; one value, or {self.num_envs}, are needed."
                )
            for row, value in enumerate(values):
                if value not in allowed[name]:
                    known = allowed[name]
                    needed = (
                        f"a whole number from 0 to {len(known) - 1} is needed"
                        if isinstance(known, range)
                        else f"an object of the split is needed, such as {known[0]}"
                    )
                    raise ParameterError(f"options[{name!r}] is {value!r}; {needed}.")
                chosen[row][name] = value if name == "object" else int(value)
        return chosen

    def _read(self, actions: Mapping[str, ArrayLike]) -> tuple[NDArray[Any], FloatArray]:
        """Return choices and logits of all rows; raise `ParameterError` if one is not allowed."""
        if not isinstance(actions, Mapping) or {*actions} != {"action", "prediction"}:
            raise ParameterError(
                f"The action is {_shown(actions)}; a dict with action and prediction is needed."
            )
        logits = self._numbers(actions["prediction"], "prediction", (len(self.classes),), np.inf)
        if self.settings.action == "place":
            return self._indices(actions["action"]), logits
        if self.settings.action == "direction":
            return self._numbers(actions["action"], "action", (2,), 1.0), logits
        return self._numbers(actions["action"], "action", (3,), FARTHEST_POINT), logits

    def _indices(self, given: ArrayLike) -> IntArray:
        choices, last = np.asarray(given), self.settings.candidates(self.parameters)
        if choices.shape != (self.num_envs,) or choices.dtype.kind not in "iu":
            raise ParameterError(
                f"action is {_shown(given)}; {self.num_envs} whole numbers are needed."
            )
        wrong = np.flatnonzero((choices < 0) | (choices > last))
        if len(wrong):
            raise ParameterError(
                f"action of row {wrong[0]} is {choices[wrong[0]]}; an index from 0 to {last} is needed."
            )
        return choices

    def _numbers(
        self, given: ArrayLike, name: str, shape: tuple[int, ...], limit: float
    ) -> FloatArray:
        values = np.asarray(given)
        if values.shape != (self.num_envs, *shape) or values.dtype.kind not in "iuf":
            raise ParameterError(
                f"{name} is {_shown(given)}; numbers of the shape {(self.num_envs, *shape)} are needed."
            )
        values = values.astype(np.float64)
        wrong = np.flatnonzero(~(np.isfinite(values) & (np.abs(values) <= limit)).all(axis=1))
        if len(wrong):
            bound = "" if np.isinf(limit) else f" from {-limit:g} to {limit:g}"
            raise ParameterError(
                f"{name} of row {wrong[0]} is {values[wrong[0]].tolist()}; finite numbers{bound} are needed."
            )
        return values

    def _try(self, rows: IntArray, choices: NDArray[Any]) -> BoolArray:
        """Try to touch in some rows, and return whether each made a touch."""
        members: dict[Body, list[int]] = {}
        for row in rows.tolist():
            members.setdefault(self.episodes[row].body, []).append(row)
        touched = np.zeros(self.num_envs, dtype=bool)
        for body, of_body in members.items():
            touched[of_body] = self._try_body(
                body, [self.episodes[row] for row in of_body], choices[of_body]
            )
        return touched[rows]

    def _try_body(
        self, body: Body, episodes: Sequence[Episode], choices: NDArray[Any]
    ) -> list[bool]:
        """Try to touch one object in its episodes, and return whether each made a touch."""
        places = self._places(body, episodes, choices)
        felt = [
            None
            if place is None or episode.refuses(place)
            else felt_nothing(place.points[0], place.normals[0])
            for episode, place in zip(episodes, places, strict=True)
        ]
        touched = [
            one is not None and place is not None and bool(place.reached[0])
            for one, place in zip(felt, places, strict=True)
        ]
        making = [row for row, is_made in enumerate(touched) if is_made]
        if making:
            landed = [
                place for place, is_made in zip(places, touched, strict=True) if place and is_made
            ]
            touches = self._touch(body, [episodes[row] for row in making], landed)
            for index, row in enumerate(making):
                felt[row] = felt_touch(landed[index].points[0], touches, index, acquired=True)
        for episode, one in zip(episodes, felt, strict=True):
            episode.add(one)
        return touched

    def _places(
        self, body: Body, episodes: Sequence[Episode], choices: NDArray[Any]
    ) -> list[Landing | None]:
        """Return the place, of one row, that each episode tries; None beside the object."""
        moves = self.settings.noise > 0
        if self.settings.action == "place":
            places = [
                one.candidate(int(choice)) for one, choice in zip(episodes, choices, strict=True)
            ]
            if not moves:
                return places
            aims = [
                None if place is None else place.points - episode.offset
                for episode, place in zip(episodes, places, strict=True)
            ]
        else:
            aims = [one.aim(choice) for one, choice in zip(episodes, choices, strict=True)]
        rows = [row for row, aim in enumerate(aims) if aim is not None]
        landed: list[Landing | None] = [None] * len(aims)
        if rows:
            joined = np.concatenate([aim for aim in aims if aim is not None])
            all_places = land(body.subject.caster, joined, self.parameters)
            for index, row in enumerate(rows):
                landed[row] = all_places.take(slice(index, index + 1))
        return landed

    def _touch(self, body: Body, episodes: Sequence[Episode], places: Sequence[Landing]) -> Touches:
        """Touch an object at one place per episode, as `sensor.touch` does."""
        sensor, scene = self.parameters.sensor, self.parameters.scene
        poses = join_poses(
            [episode.sensors(place.poses) for episode, place in zip(episodes, places, strict=True)]
        )
        fields = RandomFields(self.parameters.seed, [one.random_key for one in episodes])
        mode, caster = scene.effects.adaptive_size, body.subject.caster
        placed = (place_batch(caster, poses[rows], sensor, mode) for rows in batches(len(poses)))
        return sense(placed, sensor, scene, fields)

    def _look(self, rows: Sequence[int]) -> None:
        """Copy the pictures and places of new episodes; arrays that were returned before stay unchanged."""
        seen = {row: self.episodes[row].observe_sight() for row in rows}
        if len(seen) == self.num_envs:
            self._seen = {
                name: np.stack([seen[row][name] for row in range(self.num_envs)])
                for name in seen[0]
            }
        else:
            self._seen = {name: stacked.copy() for name, stacked in self._seen.items()}
            for row, parts in seen.items():
                for name, part in parts.items():
                    self._seen[name][row] = part
        for stacked in self._seen.values():
            stacked.flags.writeable = False

    def _observe(self) -> Observation:
        parts = [episode.observe() for episode in self.episodes]
        return {name: np.stack([part[name] for part in parts]) for name in parts[0]} | self._seen

    @property
    def _limit(self) -> float:
        """Largest coordinate: the object's radius is 1, a shift along an axis at most 1, a movement at most `noise`."""
        settings = self.settings
        return 1.5 + (settings.frame == "none") + settings.touches * settings.noise

    def _observation_space(self) -> Dict:
        settings, parameters = self.settings, self.parameters
        resolution, pixels = parameters.sensor.resolution, parameters.rendering.resolution
        limit = self._limit
        spaces: dict[str, gymnasium.Space[Any]] = {
            "imprint": Box(0.0, 1.0, (resolution, resolution)),
            "pose": Box(-limit, limit, (9,)),
            "size": Box(0.0, parameters.sensor.largest_size, ()),
            "contact": Discrete(1 + len(CONTACT_STATES)),
            "time_step": Box(-1.0, 1.0, ()),
        }
        if settings.action == "place":
            spaces["valid"] = MultiBinary(settings.candidates(parameters) + 1)
        of_sight: dict[str, gymnasium.Space[Any]] = {
            "view": Box(0, 255, (pixels, pixels, 3), np.uint8),
            "saliency": Box(0, 255, (pixels, pixels, 1), np.uint8),
            "fixations": Box(-1.0, 1.0, (settings.fixations(parameters), 2)),
            "places": Box(-limit, limit, (settings.candidates(parameters), 6)),
        }
        return Dict(
            spaces | {name: of_sight[name] for name in of_sight if name in {*settings.sight}}
        )

    def _inner_space(self) -> gymnasium.Space[Any]:
        if self.settings.action == "place":
            return Discrete(self.settings.candidates(self.parameters) + 1)
        if self.settings.action == "direction":
            return Box(-1.0, 1.0, (2,), np.float64)
        return Box(-self._limit, self._limit, (3,), np.float64)


def _make(kind: type[Any], arguments: tuple[Any, ...], settings: dict[str, Any]) -> Any:
    """Make an environment from its arguments."""
    return kind(*arguments, **settings)


def _shown(value: object) -> str:
    """Return a value in at most 60 characters."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
