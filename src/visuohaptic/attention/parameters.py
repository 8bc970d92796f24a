"""Parameters of the attention model."""

from __future__ import annotations

import json
import re
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from .errors import AttentionError
from .registry import CHANNELS, Channel, channel

NAMED_WEIGHTS = ("equal", "human_channels")
"""Names that stand for a set of weights, see `AttentionParameters`."""


@cache
def read_learnt() -> dict[str, Any]:
    """Give weights fitted to where people looked, `channels` and `terms` by name, and their origin."""
    text = files(__package__).joinpath("human_weights.json").read_text(encoding="utf-8")
    found: dict[str, Any] = json.loads(text)
    return found


def _no_truth_value(value: object) -> object:
    # Pydantic reads true as 1.
    if isinstance(value, bool):
        raise PydanticCustomError("truth_value", "a number is needed")
    return value


_Whole = Annotated[int, BeforeValidator(_no_truth_value)]
_Number = Annotated[float, BeforeValidator(_no_truth_value)]


class ChannelWeights(BaseModel):
    """How much each channel adds to the saliency map; a channel of weight 0 is not computed."""

    # Each entry of the registry has a field, so that the entry is all there is to write.
    model_config = ConfigDict(frozen=True, extra="forbid")

    if TYPE_CHECKING:

        def __init__(self, **weights: float) -> None: ...

    @model_validator(mode="after")
    def _one_above_zero(self) -> Self:
        if not any(self.model_dump().values()):
            raise ValueError("all channel weights are 0; at least one above 0 is needed.")
        return self

    @classmethod
    def add(cls, *entries: Channel) -> None:
        """Add the weights of channels."""
        for entry in entries:
            weight: Any = Field(entry.weight, ge=0.0, description=entry.description)
            field = FieldInfo.from_annotated_attribute(_Number, weight)
            cls.__pydantic_fields__[entry.name] = field
        cls.model_rebuild(force=True)

    @classmethod
    def only(cls, *channels: str) -> Self:
        """Give the named channels weight 1 and all others 0; `AttentionError` if one is unknown."""
        chosen = {channel(name).name for name in channels}
        return cls.model_validate({name: float(name in chosen) for name in CHANNELS})


ChannelWeights.add(*CHANNELS.values())

_SOURCES: dict[str, str] = {}


def add_channel(entry: Channel, source: str) -> None:
    """Add a channel of a plug-in, and its weight in all parameters that are made from now on.

    One that the same source added is replaced. Raises `AttentionError` if its name is taken, or can't be one.
    """
    taken = entry.name in CHANNELS and _SOURCES.get(entry.name) != source
    if taken or not re.fullmatch("[a-z_]+", entry.name):
        raise AttentionError(
            f"{entry.name!r} can't name a channel; letters a to z and _ are allowed, and each name once."
        )
    ChannelWeights.add(entry)
    AttentionParameters.model_rebuild(force=True)
    CHANNELS[entry.name] = entry
    _SOURCES[entry.name] = source


def _or_a_name(schema: dict[str, Any]) -> None:
    """Let editors take the names that stand for a set of weights."""
    schema["anyOf"] = [{"$ref": schema.pop("$ref")}, {"enum": list(NAMED_WEIGHTS)}]


class AttentionParameters(BaseModel):
    """Channels, their combination, and the choice of fixations.

    The default is 1 for the five channels that the paper names, and 0 for the others. `weights` may
    be a name. ``equal``: 1 for every channel. ``human_channels``: the eight channel weights that were
    fitted to where people looked (`read_learnt`), three of which are 0, without the terms that were
    fitted with them.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    weights: ChannelWeights = Field(default_factory=ChannelWeights, json_schema_extra=_or_a_name)
    normalisation: Literal["local_maxima", "iterative", "none"] = Field(
        "local_maxima",
        description="How a map with one strong peak is promoted over one with many: the operator N",
    )
    fixations: _Whole = Field(5, ge=1, le=32, description="Fixations in each view")
    inhibition: Literal["surface", "image"] = Field(
        "surface",
        description="Whether return is inhibited by distance on the `surface` or in the `image`",
    )
    focus_radius: _Number = Field(
        0.2,
        gt=0.0,
        description="Radius of the focus on the surface, in the units of the points (here object "
        "radii); no two fixations are closer",
    )
    focus_fraction: _Number = Field(
        0.1,
        gt=0.0,
        le=1.0,
        description="Radius of the focus in the image, as a fraction of the view's longer edge",
    )
    inhibition_falloff: _Number = Field(
        1.0,
        ge=0.0,
        description="Width of the rim over which inhibition fades out (focus radii); 0 is a disk",
    )

    @model_validator(mode="before")
    @classmethod
    def _named_weights(cls, values: Any) -> Any:
        """Take a name among `NAMED_WEIGHTS` for the weights that it stands for."""
        if not isinstance(values, dict) or not isinstance(values.get("weights"), str):
            return values
        name = values["weights"]
        if name not in NAMED_WEIGHTS:
            raise ValueError(
                f"weights is {name!r}; {', '.join(NAMED_WEIGHTS)} or a number a channel is allowed."
            )
        if name == "equal":
            return {**values, "weights": dict.fromkeys(CHANNELS, 1.0)}
        # A channel that was not there has no fitted weight.
        return {**values, "weights": dict.fromkeys(CHANNELS, 0.0) | read_learnt()["channels"]}
