"""A policy, the view that it is given, and the results of its tries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RegistryError
from visuohaptic.fixations.places import (
    ProbingLocations,
    Unreachable,
    check_unreachable,
    is_visible,
    turn_towards,
)
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster

PLACES = 256
"""Locations that are spread over an object; a viewpoint offers the locations that it sees."""

FARTHEST_POINT = 1e6
"""Limit of the coordinates of a point, object radii: the nearest face is found in float32, which overflows at 1e19."""

MAX_SURFACE_DISTANCE = 0.1
"""Largest allowed distance of a chosen point from the surface, object radii: points beyond are probably in another
frame."""


@dataclass(frozen=True, eq=False)
class Felt:
    """The result of one try to touch.

    Attributes
    ----------
    point, normal : ndarray of shape (3,)
        The location and the outward unit normal of the sensor, object frame. A policy's arrays are read-only.
    acquired : bool
        Whether the sensor could reach the location. Without reach there is an imprint only if parameter
        ``unreachable`` is ``keep``.
    imprint : ndarray of shape (r, r) or (taxels,), float32, or None
        1 is the imprint's nearest point and 0 its farthest; with `sensor.normalisation` ``absolute``, 1 is contact
        and 0 is out of the depth range. None without a touch.
    sensor_size : float or None
        Edge of the sensor's square, object radii; None without a touch.
    contact_state : str or None
        A value of `tables.phases.CONTACT_STATES`; None without a touch.
    """

    point: FloatArray
    normal: FloatArray
    acquired: bool
    imprint: NDArray[np.float32] | None = None
    sensor_size: float | None = None
    contact_state: str | None = None


@dataclass(frozen=True, eq=False)
class PolicyView:
    """The knowledge of a policy at a viewpoint: not the object's name, and not its class.

    Attributes
    ----------
    caster : RayCaster
        The object's surface, prepared for rays; ``caster.surface`` has its vertices and faces.
    camera : Camera
        The viewpoint.
    generator : numpy.random.Generator
        Random numbers that depend on the seed, the policy, the object and the viewpoint only.
    find_places : callable
        ``find_places()`` returns locations that are spread over the object.
    """

    caster: RayCaster
    camera: Camera
    generator: np.random.Generator
    find_places: Callable[[], ProbingLocations]

    @cached_property
    def places(self) -> ProbingLocations:
        """The visible locations among `PLACES` that are spread over the object; normals point to the camera."""
        spread = self.find_places()
        visible = np.flatnonzero(is_visible(self.caster, self.camera, spread.points))
        return turn_towards(spread.take(visible), self.camera)


@dataclass(frozen=True)
class Policy:
    """A way to choose the next location by the touches so far.

    Attributes
    ----------
    name, label : str
        Name in parameters and tables, and name in the report.
    next_location : callable
        ``next_location(view, tries)`` takes a `PolicyView` and all tries from this viewpoint so far, a tuple of
        `Felt`. It returns a new point (3,) on the surface, object frame, or None to stop. The result must depend
        on the arguments only.
    random : bool
        Whether ``view.generator`` changes the locations.
    unreachable, random_stream : str, optional
        As for `Strategy`.
    longest_seconds : float
        Longest allowed wall time of one call of `next_location`, in seconds; `math.inf` for no bound. A slower
        call ends in a `PolicyError`. The time is compared after the call, so a call that never returns is not
        stopped.

    Raises
    ------
    RegistryError
        If `longest_seconds` is no positive number, or `unreachable` is unknown.
    """

    name: str
    label: str
    next_location: Callable[[PolicyView, Sequence[Felt]], ArrayLike | None]
    random: bool = True
    unreachable: Unreachable | None = None
    random_stream: str | None = None
    longest_seconds: float = 60.0

    def __post_init__(self) -> None:
        """Check the treatment of places out of reach, and the bound."""
        check_unreachable(f"policy {self.name}", self.unreachable)
        check_bound(f"policy {self.name}", self.longest_seconds)

    @property
    def needs_view(self) -> bool:
        """False: no policy needs a rendered view."""
        return False


def check_bound(policy: str, longest_seconds: float) -> None:
    """Raise `RegistryError`, with the kind and name `policy`, if a bound of time is no positive number."""
    is_number = isinstance(longest_seconds, int | float)
    # bool is a subclass of int.
    if not is_number or isinstance(longest_seconds, bool) or not longest_seconds > 0:
        raise RegistryError(
            f"{policy}: longest_seconds is {longest_seconds!r}; a positive number of seconds is needed."
        )
