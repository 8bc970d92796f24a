"""The single environment: a vector environment with one row."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from numpy.typing import ArrayLike

from visuohaptic.environment.episodes import Observation
from visuohaptic.environment.vector import TouchVectorEnv


class TouchEnv(gymnasium.Env[Observation, Any]):
    """An episode at a time of `TouchVectorEnv`, with the same arguments without `num_envs`.

    Attributes
    ----------
    vector : TouchVectorEnv
        The vector environment with one row, which computes everything.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012 - as Gymnasium declares it

    def __init__(self, *, render_mode: None = None, **arguments: Any) -> None:
        self.vector = TouchVectorEnv(1, render_mode=render_mode, **arguments)
        self.render_mode = render_mode
        self.observation_space = self.vector.single_observation_space
        self.action_space = self.vector.single_action_space
        self.inner_action_space = self.vector.single_inner_action_space
        self.prediction_space = self.vector.single_prediction_space
        self.prediction_target_space = self.vector.single_prediction_target_space
        self.loss_fn, self.classes = self.vector.loss_fn, self.vector.classes
        self._ended = False

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode; see `TouchVectorEnv.reset`."""
        super().reset(seed=seed)
        self.vector.generators = [self.np_random]
        observation, info = self.vector.reset(options=options)
        self._ended = False
        return _first(observation), {name: values[0] for name, values in info.items()}

    def step(
        self, action: Mapping[str, ArrayLike]
    ) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Touch, and score the prediction; see `TouchVectorEnv.step`. After the end `reset` is needed."""
        if self._ended:
            raise ResetNeeded("The episode has ended; call reset first.")
        if isinstance(action, Mapping):
            action = {name: np.asarray(value)[None] for name, value in action.items()}
        observation, rewards, ended, _, info = self.vector.step(action)
        self._ended = bool(ended[0])
        prediction = {name: values[0] for name, values in info["prediction"].items()}
        told = {
            "base_reward": float(info["base_reward"][0]),
            "prediction": prediction,
            "touched": bool(info["touched"][0]),
        }
        return _first(observation), float(rewards[0]), self._ended, False, told

    def close(self) -> None:
        """Close the environment; later calls are refused."""
        self.vector.close()


def _first(observation: Observation) -> Observation:
    """Return a copy of the observation of the first row; the contact is an integer, as its space has."""
    first = {name: np.array(values[0]) for name, values in observation.items()}
    return first | {"contact": observation["contact"][0]}
