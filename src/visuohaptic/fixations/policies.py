"""Policies: strategies that choose each next place by what was felt before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RegistryError
from visuohaptic.fixations.places import ProbingLocations, sees, turn_towards
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster

PLACES = 256
"""Places spread over an object, of which each viewpoint offers those that it sees."""


@dataclass(frozen=True, eq=False)
class Felt:
    """One try to touch.

    Attributes
    ----------
    point, normal : ndarray of shape (3,)
        Where the sensor was set down, and its outward unit normal, object frame.
    acquired : bool
        Whether the sensor could reach the place. Where it could not, nothing is felt, unless the
        parameters say that such places are touched as far as the sensor comes.
    imprint : ndarray of shape (r, r), float32, or None
        1 is contact and 0 is out of reach; None where nothing was felt.
    sensor_size : float or None
        Edge of the sensor's square, object radii.
    contact_state : str or None
        One of `tables.phases.CONTACT_STATES`.
    """

    point: FloatArray
    normal: FloatArray
    acquired: bool
    imprint: NDArray[np.float32] | None = None
    sensor_size: float | None = None
    contact_state: str | None = None


@dataclass(frozen=True, eq=False)
class PolicyView:
    """What a policy knows before the first touch from a viewpoint: neither the object's name nor its class.

    Attributes
    ----------
    caster : RayCaster
        The object's surface, prepared for rays; ``caster.surface`` has its vertices and faces.
    camera : Camera
        The viewpoint.
    generator : numpy.random.Generator
        It depends on the seed, the policy, the object and the viewpoint only.
    find_places : callable
        Returns places that are spread over the object.
    """

    caster: RayCaster
    camera: Camera
    generator: np.random.Generator
    find_places: Callable[[], ProbingLocations]

    @cached_property
    def places(self) -> ProbingLocations:
        """Those of `PLACES` places spread over the object that the viewpoint sees, with normals towards the camera."""
        spread = self.find_places()
        seen = np.flatnonzero(sees(self.caster, self.camera, spread.points))
        return turn_towards(spread.take(seen), self.camera)


@dataclass(frozen=True)
class Policy:
    """A way to choose where to touch next, by what was felt so far.

    Attributes
    ----------
    name : str
        What parameters and tables call it.
    label : str
        What the report calls it.
    next_location : callable
        ``next_location(view, touches)`` takes a `PolicyView` and all tries from this viewpoint so far,
        a tuple of `Felt`. It returns a point (3,) on the surface, object frame, which no earlier try
        was at, or None to stop. It must depend on its arguments only.
    random : bool
        Whether ``view.generator`` changes the places.
    unreachable : {"replace", "keep"}, optional
        What is done with places out of reach, whatever `probing.unreachable` says; without it as that
        says.
    chance : str, optional
        Name of its generators, also of the sensor's noise; without it its own name.
    longest_seconds : float
        Longest allowed time of one call of `next_location`, in seconds of wall time; `math.inf` for no bound.
        A slower call ends in a `PolicyError`. The time is compared after the call, so a call that never
        returns is not stopped.

    Raises
    ------
    RegistryError
        If `longest_seconds` is no positive number.
    """

    name: str
    label: str
    next_location: Callable[[PolicyView, Sequence[Felt]], ArrayLike | None]
    random: bool = True
    unreachable: Literal["replace", "keep"] | None = None
    chance: str | None = None
    longest_seconds: float = 60.0

    def __post_init__(self) -> None:
        """Check the bound."""
        bound = self.longest_seconds
        # bool is a subclass of int.
        if not isinstance(bound, int | float) or isinstance(bound, bool) or not bound > 0:
            raise RegistryError(
                f"policy {self.name}: longest_seconds is {bound!r}; a positive number of seconds is needed."
            )

    @property
    def looks(self) -> bool:
        """A policy needs no rendered view."""
        return False
