"""Policies of the experiment as agents of the environment, and agents as policies of the experiment.

Both make the same touches, bit for bit, with objects that stay where they are, draw 0 of the same `random_stream`, and
in frames other than ``full`` with a sensor that is upright in the object's frame, as the experiment's sensor is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.active.policies import Felt, Policy, PolicyView
from visuohaptic.active.registry import policy_of
from visuohaptic.active.sessions import PolicySession, start_sessions
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ParameterError
from visuohaptic.environment.episodes import Episode, Observation, draw_frame
from visuohaptic.environment.settings import TouchSettings
from visuohaptic.environment.sight import Body, land, look
from visuohaptic.geometry.subject import Subject
from visuohaptic.parameters import ExperimentParameters, as_parameters

if TYPE_CHECKING:
    from visuohaptic.environment.single import TouchEnv
    from visuohaptic.environment.vector import TouchVectorEnv

Agent = Callable[[Observation], ArrayLike]
"""Takes an observation of a single environment, and returns ``action`` without the prediction."""


class PolicyAgent:
    """Chooses points by a policy of the experiment, for an environment with action ``object_point``.

    In frame ``full`` action ``point`` is the same.

    Parameters
    ----------
    environment : TouchVectorEnv or TouchEnv
        The environment, which must have been reset before `choose`.
    policy : str
        Name of a policy.

    Raises
    ------
    ParameterError
        If the environment has another action, noise, or a sensor that is upright in another frame than the object's.
    RegistryError
        If no policy has the name.
    """

    def __init__(self, environment: TouchVectorEnv | TouchEnv, policy: str) -> None:
        self._vector: Any = getattr(environment, "vector", environment)
        settings = self._vector.settings
        if settings.action != "object_point" and (settings.action, settings.frame) != (
            "point",
            "full",
        ):
            raise ParameterError(
                f"action is {settings.action!r} in frame {settings.frame!r}; policies choose points of the object's own "
                "frame: action 'object_point' is needed."
            )
        _check_exchange(settings)
        self._policy = policy_of(policy)
        # Per row: the number of the episode, and its session.
        self._sessions: dict[int, tuple[int, PolicySession]] = {}

    def choose(self) -> list[FloatArray | None]:
        """Return the next point (3,) of each row, object frame; None if the policy stops in this row.

        Raises `PolicyError` if the policy fails.
        """
        points = []
        for row, number in enumerate(self._vector.numbers.tolist()):
            if row not in self._sessions or self._sessions[row][0] != number:
                self._sessions[row] = number, self._session(row)
            session = self._sessions[row][1]
            session.felt = list(self._vector.episodes[row].felt)
            points.append(None if session.stopped else session.choose())
        return points

    def _session(self, row: int) -> PolicySession:
        episode, parameters = self._vector.episodes[row], self._vector.parameters
        subject = Subject(
            episode.body.key, lambda: episode.body.subject.caster, [episode.viewpoint]
        )
        [session] = start_sessions(
            subject,
            [self._policy],
            parameters.viewpoints,
            parameters.seed,
            parameters.probing.unreachable,
        )
        return session


def agent_policy(
    name: str,
    label: str,
    make_agent: Callable[[], Agent],
    parameters: ExperimentParameters | Mapping[str, Any] | None = None,
    **settings: Any,
) -> Policy:
    """Return a policy, which `visuohaptic.register` takes, that touches where an agent of the environment touches.

    Parameters
    ----------
    name, label : str
        As for `Policy`.
    make_agent : callable
        Returns an agent for one sequence of touches. The agent is called with the observation of each step in turn, so
        it may have a memory; the result must depend on these observations only.
    parameters : ExperimentParameters or mapping, optional
        Parameters of the experiment, as for `TouchVectorEnv`.
    **settings
        Settings with which the agent was trained, as for `TouchVectorEnv`; `random_stream` is `name`.

    Returns
    -------
    Policy
        The policy. It stops where the agent ends its episode, and after `touches` tries. Tries beside the object, or at
        a place that was tried before, are seen by the agent only.

    Raises
    ------
    ParameterError
        If a setting is not allowed, the object moves, or the sensor is upright in another frame than the object's.
    """
    checked = TouchSettings.checked({**settings, "random_stream": name})
    _check_exchange(checked)
    chosen, steps = as_parameters(parameters), WeakKeyDictionary[PolicyView, _Steps]()

    def next_location(view: PolicyView, tries: Sequence[Felt]) -> FloatArray | None:
        if view not in steps:
            steps[view] = _Steps(view, make_agent(), checked, chosen)
        return steps[view].next_point(tries)

    return Policy(name, label, next_location, random=False)


class _Steps:
    """The episode of an agent at a viewpoint of the experiment."""

    def __init__(
        self,
        view: PolicyView,
        agent: Agent,
        settings: TouchSettings,
        parameters: ExperimentParameters,
    ) -> None:
        # A policy is told neither object nor viewpoint. The noise of its touches is drawn by the experiment.
        body = Body("unknown/object", lambda: view.caster.surface, settings, parameters)
        sight = look(view, settings, parameters)
        # A copy, so that a policy of this view gets its first numbers too. The environment draws from the same state.
        frame = draw_frame(settings.frame, deepcopy(view.generator))
        self._episode = Episode(body, 0, sight, settings.random_stream, frame, settings)
        self._agent, self._seen = agent, self._episode.observe_sight()

    def next_point(self, tries: Sequence[Felt]) -> FloatArray | None:
        episode = self._episode
        if len(tries) > len(episode.felt):
            episode.add(tries[-1])
        while not episode.complete:
            choice = np.asarray(self._agent(episode.observe() | self._seen))
            aim = self._aim(choice)
            if aim is None and choice.ndim == 0 and int(choice) == len(episode.valid) - 1:
                return None
            if aim is not None:
                return aim
            episode.add(None)
        return None

    def _aim(self, choice: Any) -> FloatArray | None:
        """Return the point (3,) that the agent aims at; None for a try that the experiment does not make."""
        episode, view = self._episode, self._episode.sight.policy_view
        if episode.settings.action == "place":
            place = episode.candidate(int(choice))
        else:
            aim = episode.aim(choice.astype(np.float64))
            place = None if aim is None else land(view.caster, aim, episode.body.parameters)
        return None if place is None or episode.refuses(place) else place.aims[0]


def _check_exchange(settings: TouchSettings) -> None:
    """Raise `ParameterError` if the experiment can't make the touches of an environment."""
    if settings.noise:
        raise ParameterError(
            f"noise is {settings.noise:g}; objects of the experiment stay where they are: noise 0 is needed."
        )
    if settings.frame != "full" and settings.upright != "object":
        raise ParameterError(
            f"upright is {settings.upright!r} in frame {settings.frame!r}; the experiment's sensor is upright in the "
            "object's frame, so that its imprints lie otherwise: upright 'object' is needed."
        )
