"""The channels: one entry holds all that there is to know of each.

Heavy libraries are imported by the functions that use them, so that the channels' names and
weights can be checked without.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from .errors import AttentionError

if TYPE_CHECKING:
    from .channels import Stack, WorkingView
    from .parameters import AttentionParameters
    from .pyramid import Plane


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
    planes: Callable[[WorkingView, AttentionParameters], list[Plane]] | None = None
    stacks: Callable[[WorkingView, AttentionParameters], list[Stack]] | None = None
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


def add_channel(entry: Channel, source: str) -> None:
    """Add a channel of a plug-in, the last one; one that the same source added before is replaced.

    Raises `AttentionError` if its name is taken, or can't be one.
    """
    taken = entry.name in ENTRIES and _SOURCES.get(entry.name) != source
    if taken or not re.fullmatch("[a-z_]+", entry.name):
        raise AttentionError(
            f"{entry.name!r} can't name a channel; letters a to z and _ are allowed, and each name once."
        )
    from .parameters import grow_weights

    grow_weights(entry)
    _ENTRIES[entry.name], _SOURCES[entry.name] = entry, source


def _by_name(*channels: Channel) -> dict[str, Channel]:
    names = [entry.name for entry in channels]
    if len(set(names)) < len(names):
        raise AttentionError(f"channels are {', '.join(names)}; each name is allowed once.")
    return dict(zip(names, channels, strict=True))


def _colour(view: WorkingView, _: AttentionParameters) -> list[Plane]:
    from .channels import colour_planes

    return colour_planes(view)


def _intensity(view: WorkingView, _: AttentionParameters) -> list[Plane]:
    from .channels import intensity_plane

    return [intensity_plane(view)]


def _orientation(view: WorkingView, parameters: AttentionParameters) -> list[Stack]:
    from .channels import orientation_stacks

    return orientation_stacks(view, parameters)


def _contrast(view: WorkingView, _: AttentionParameters) -> list[Plane]:
    from .channels import contrast_plane

    return [contrast_plane(view)]


def _curvature(view: WorkingView, _: AttentionParameters) -> list[Plane]:
    from .channels import curvature_plane

    return [curvature_plane(view)]


def _edge(view: WorkingView, _: AttentionParameters) -> list[Plane]:
    from .channels import edge_plane

    return [edge_plane(view)]


def _entropy(view: WorkingView, parameters: AttentionParameters) -> list[Plane]:
    from .channels import entropy_plane

    return [entropy_plane(view, parameters.entropy_bins)]


def _symmetry(view: WorkingView, parameters: AttentionParameters) -> list[Plane]:
    from .channels import symmetry_plane

    return [symmetry_plane(view, parameters.symmetry_radii)]


_ENTRIES = _by_name(
    Channel(
        "colour", "Red-green and blue-yellow double opponency", _colour,
        count=2, two_sided=True, needs="hues",
    ),
    Channel(
        "intensity", "Light against dark surroundings", _intensity,
        two_sided=True, needs="colours",
    ),
    Channel("orientation", "Gabor energy at each angle", stacks=_orientation, needs="colours"),
    Channel("contrast", "Local root mean square contrast", _contrast, needs="colours"),
    Channel("curvature", "Curvedness of the surface", _curvature, needs="curvature"),
    Channel("edge", "Gradient of intensity", _edge, needs="colours", weight=0.0),
    Channel("entropy", "Entropy of the local grey level histogram", _entropy, needs="colours", weight=0.0),
    Channel("symmetry", "Radial symmetry of gradients", _symmetry, needs="colours", weight=0.0),
)  # fmt: skip
_SOURCES: dict[str, str] = {}

ENTRIES: Mapping[str, Channel] = MappingProxyType(_ENTRIES)
"""Every channel, in the order in which maps are added up."""
