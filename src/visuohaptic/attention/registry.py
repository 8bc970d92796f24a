"""The channels: one entry holds all that there is to know of each.

Heavy libraries are imported by the functions that use them, so that the channels' names and
weights can be checked without.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType
from typing import Any, Literal, Protocol, TypeVar

from .errors import AttentionError


class _Named(Protocol):
    @property
    def name(self) -> str: ...


Entry = TypeVar("Entry", bound=_Named)


@dataclass(frozen=True)
class Channel:
    """One feature that draws the eye. It has either planes or stacks.

    Attributes
    ----------
    name : str
        What parameters and tables call it.
    description : str
        What it measures, in a few words.
    planes : callable, optional
        Takes a view on the working image, n rows and columns, and the model's parameters; gives
        `count` planes, shape (n, n), float32, multiplied by the view's certainty.
    stacks : callable, optional
        Takes the same; gives planes of its own for each centre level.
    count : int
        How many planes it has.
    two_sided : bool
        Whether places below their surroundings draw the eye as those above do.
    needs : {"hues", "colours", "curvature"}, optional
        What must vary over a view, or be there, for the channel to see anything: the channel is
        skipped in views without. A channel that names nothing is never skipped.
    weight : float
        How much it adds to the saliency map by default.
    """

    name: str
    description: str
    planes: Callable[..., list[Any]] | None = None
    stacks: Callable[..., list[Any]] | None = None
    count: int = 1
    two_sided: bool = False
    needs: Literal["hues", "colours", "curvature"] | None = None
    weight: float = 1.0

    def __post_init__(self) -> None:
        if (self.planes is None) == (self.stacks is None):
            raise AttentionError(
                f"channel {self.name} has {'neither planes nor' if self.planes is None else 'planes and'}"
                " stacks; one of the two is needed."
            )


def channel(name: str) -> Channel:
    """Give a channel by its name; `AttentionError` if there is none."""
    if name not in ENTRIES:
        raise AttentionError(f"{name!r} is no channel; {', '.join(ENTRIES)} are allowed.")
    return ENTRIES[name]


def add(entry: Channel) -> None:
    """Add a channel, the last one, or replace the one of its name."""
    _ENTRIES[entry.name] = entry


def by_name(*entries: Entry) -> dict[str, Entry]:
    """Give entries by their names; `AttentionError` if two have one name."""
    names = [entry.name for entry in entries]
    if len(set(names)) < len(names):
        raise AttentionError(f"entries are {', '.join(names)}; each name is allowed once.")
    return dict(zip(names, entries, strict=True))


def _measure(name: str, *settings: str) -> Callable[..., list[Any]]:
    """Name a function of `channels`, which is imported when it is called, and the parameters that it takes."""

    def planes(view: Any, parameters: Any) -> list[Any]:
        function = getattr(import_module(".channels", __package__), name)
        found = function(view, *(getattr(parameters, setting) for setting in settings))
        return found if isinstance(found, list) else [found]

    return planes


def _orientation(view: Any, parameters: Any) -> list[Any]:
    return import_module(".channels", __package__).orientation_stacks(view, parameters)


_ENTRIES = by_name(
    Channel(
        "colour", "Red-green and blue-yellow double opponency", _measure("colour_planes"),
        count=2, two_sided=True, needs="hues",
    ),
    Channel(
        "intensity", "Light against dark surroundings", _measure("intensity_plane"),
        two_sided=True, needs="colours",
    ),
    Channel("orientation", "Gabor energy at each angle", stacks=_orientation, needs="colours"),
    Channel("contrast", "Local root mean square contrast", _measure("contrast_plane"), needs="colours"),
    Channel("curvature", "Curvedness of the surface", _measure("curvature_plane"), needs="curvature"),
    Channel("edge", "Gradient of intensity", _measure("edge_plane"), needs="colours", weight=0.0),
    Channel("entropy", "Entropy of the local grey level histogram", _measure("entropy_plane", "entropy_bins"), needs="colours", weight=0.0),
    Channel("symmetry", "Radial symmetry of gradients", _measure("symmetry_plane", "symmetry_radii"), needs="colours", weight=0.0),
)  # fmt: skip

ENTRIES: Mapping[str, Channel] = MappingProxyType(_ENTRIES)
"""Every channel, in the order in which maps are added up."""
