"""The registry of strategies that choose all locations before the first touch, and the look-up of draws."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from visuohaptic.base.draw_names import DRAW_MARK
from visuohaptic.base.errors import RegistryError
from visuohaptic.base.registry import Registry
from visuohaptic.fixations.places import Unreachable, check_unreachable
from visuohaptic.fixations.strategies import (
    anywhere,
    contour,
    curvature,
    farthest_point,
    fixation,
    human,
    random_walk,
    visible,
)


@dataclass(frozen=True)
class Strategy:
    """A way to choose locations before the first touch.

    Attributes
    ----------
    name, label : str
        Name in parameters and tables, and name in the report.
    choose : callable
        ``choose(viewpoint, attention, generator)`` takes a `Viewpoint`, `AttentionParameters` and a
        `numpy.random.Generator`. It returns at most `attention.fixations` locations in the order of touching: a
        `Scanpath`, or `ProbingLocations`. Their normals point out of the object or towards the camera, unless
        `is_turned` is False: such normals are turned out of the object afterwards. With the same generator state, a
        smaller number of fixations must return the first of the same locations.
    random : bool
        Whether the generator changes the locations.
    needs_view : bool
        Whether `choose` needs rendered views and saliency: its viewpoint is then an `AttendedView`. Otherwise
        `choose` must work with any `Viewpoint`.
    unreachable : {"replace", "skip", "keep"}, optional
        Treatment of locations out of reach; by default as parameter `probing.unreachable` says.
    random_stream : str, optional
        Name from which the random numbers of `choose` and of the sensor noise are seeded, by default `name`.
        Strategies with the same `random_stream` get the same random numbers.

    Raises
    ------
    RegistryError
        If `unreachable` is unknown.
    """

    name: str
    label: str
    choose: Callable[..., Any]
    random: bool = True
    needs_view: bool = True
    unreachable: Unreachable | None = None
    random_stream: str | None = None

    def __post_init__(self) -> None:
        """Check the treatment of places out of reach."""
        check_unreachable(f"strategy {self.name}", self.unreachable)


PLANNED: Registry[Strategy] = Registry(
    "probing strategy",
    Strategy(
        "fixation",
        "eye fixations",
        fixation.choose,
        random=False,
    ),
    Strategy(
        "random",
        "random probing",
        anywhere.choose,
        needs_view=False,
        unreachable="replace",
    ),
    Strategy(
        "random_anywhere",
        "random probing, out of reach too",
        anywhere.choose,
        needs_view=False,
        unreachable="keep",
        random_stream="random",
    ),
    Strategy(
        "random_visible",
        "random probing of what is seen",
        visible.choose,
        needs_view=False,
    ),
    Strategy(
        "random_walk",
        "a random walk over the surface",
        random_walk.choose,
        needs_view=False,
    ),
    Strategy(
        "farthest_point",
        "farthest points",
        farthest_point.choose,
        needs_view=False,
    ),
    Strategy(
        "curvature",
        "the most curved places",
        curvature.choose,
        random=False,
    ),
    Strategy(
        "contour",
        "places along the outline",
        contour.choose,
        random=False,
    ),
    Strategy(
        "human",
        "where people are predicted to look",
        human.choose,
        random=False,
    ),
)
"""The strategies that choose all locations before the first touch; `active.registry.STRATEGIES` adds the policies."""


def entry_of(registry: Registry[Any], name: str) -> Any:
    """Return an entry of a registry by its name, or by the name of a further draw such as ``random#2``.

    A draw is a random choice of locations; the plain name ``random`` is draw 0. For ``random#2`` the entry of
    ``random`` is returned with new `name`, `label` and `random_stream`, so its random numbers differ from those of
    ``random#1``. Strategies that share `random_stream` share the random numbers of each draw too.

    Raises
    ------
    RegistryError
        If the name is unknown, the entry is not random, or the number of the draw is not in 1 to 999999.
    """
    if DRAW_MARK not in name:
        return registry[name]
    strategy, _, draw = name.partition(DRAW_MARK)
    entry = registry[strategy]
    if not entry.random or not re.fullmatch("[1-9][0-9]{0,5}", draw):
        raise RegistryError(
            f"{name!r} is no draw of a random strategy; the name of a random strategy, {DRAW_MARK} and a number "
            "from 1 to 999999 are allowed, such as 'random#1'."
        )
    random_stream = f"{entry.random_stream or strategy}{DRAW_MARK}{draw}"
    return replace(
        entry, name=name, label=f"{entry.label}, draw {draw}", random_stream=random_stream
    )
