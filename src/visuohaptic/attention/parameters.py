"""Parameters of the attention model."""

from __future__ import annotations

import json
import re
from importlib.resources import files
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from .errors import AttentionError
from .registry import CHANNELS, Channel, channel

SMALLEST, LARGEST = 1e-12, 1e12
"""Limits of weights and lengths above 0."""

NAMED_WEIGHTS = ("equal", "human_channels")
"""Names of sets of weights, see `AttentionParameters`."""


def read_fitted_weights() -> dict[str, Any]:
    """Read the weights that were fitted to people's gaze: `channels` and `terms` by name, and their origin.

    Each call returns a new dict, which the caller may change.
    """
    text = files(__package__).joinpath("human_weights.json").read_text(encoding="utf-8")
    weights: dict[str, Any] = json.loads(text)
    return weights


def _refuse_bool(value: object) -> object:
    # Pydantic would read true as 1.
    if isinstance(value, bool):
        raise PydanticCustomError("truth_value", "a number is needed")
    return value


def _refuse_extremes(value: float) -> float:
    # Filters are of float32, which holds 1e-38 to 3e38.
    if value and not SMALLEST <= abs(value) <= LARGEST:
        raise PydanticCustomError(
            "magnitude",
            "0 or a number between {smallest} and {largest} is needed",
            {"smallest": f"{SMALLEST:g}", "largest": f"{LARGEST:g}"},
        )
    return value


_Whole = Annotated[int, BeforeValidator(_refuse_bool)]
_Number = Annotated[float, BeforeValidator(_refuse_bool), AfterValidator(_refuse_extremes)]


class ChannelWeights(BaseModel):
    """Weight of each channel in the saliency map; channels of weight 0 are not computed."""

    # The registry adds the fields, so a new channel needs only its entry there.
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    if TYPE_CHECKING:

        def __init__(self, **weights: float) -> None: ...

    @model_validator(mode="after")
    def _check_not_all_zero(self) -> Self:
        if not any(self.model_dump().values()):
            raise ValueError("all channel weights are 0; a weight above 0 is needed.")
        return self

    @classmethod
    def add(cls, *entries: Channel) -> None:
        """Add a field per channel."""
        for entry in entries:
            weight: Any = Field(entry.weight, ge=0.0, description=entry.description)
            field = FieldInfo.from_annotated_attribute(_Number, weight)
            cls.__pydantic_fields__[entry.name] = field
        cls.model_rebuild(force=True)

    @classmethod
    def only(cls, *channels: str) -> Self:
        """Return weight 1 for the named channels and 0 for all others.

        Raises `AttentionError` if a channel is unknown.
        """
        chosen = {channel(name).name for name in channels}
        return cls.model_validate({name: float(name in chosen) for name in CHANNELS})


ChannelWeights.add(*CHANNELS.values())

_SOURCES: dict[str, str] = {}


def add_channel(entry: Channel, source: str) -> None:
    """Add a channel of a plug-in, and its weight to all parameters that are built later.

    An earlier channel of the same name and source is replaced. Raises `AttentionError` if another channel has the
    name, or the name has other characters than a to z and _.
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


def _allow_names(schema: dict[str, Any]) -> None:
    """Add the names of sets of weights to the schema for editors."""
    schema["anyOf"] = [{"$ref": schema.pop("$ref")}, {"enum": list(NAMED_WEIGHTS)}]


class AttentionParameters(BaseModel):
    """Channels, their combination, and the choice of fixations.

    By default the five channels of the paper have weight 1 and all others 0. `weights` may also be a name.
    ``equal``: 1 for every channel. ``human_channels``: the channel weights that were fitted to people's gaze
    (`read_fitted_weights`), without the terms.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    weights: ChannelWeights = Field(default_factory=ChannelWeights, json_schema_extra=_allow_names)
    normalisation: Literal["local_maxima", "iterative", "none"] = Field(
        "local_maxima",
        description="Operator N, which raises maps with one strong peak above maps with many peaks",
    )
    fixations: _Whole = Field(5, ge=1, le=32, description="Fixations in each view")
    inhibition: Literal["surface", "image"] = Field(
        "surface",
        description="Whether inhibition of return measures distance on the `surface` or in the `image`",
    )
    focus_radius: _Number = Field(
        0.2,
        gt=0.0,
        description="Radius of the focus on the surface (object radii); no two fixations of a view are closer",
    )
    focus_fraction: _Number = Field(
        0.1,
        gt=0.0,
        le=1.0,
        description="Radius of the focus in the image (of the view's longer edge)",
    )
    inhibition_falloff: _Number = Field(
        1.0,
        ge=0.0,
        description="Width of the rim over which inhibition fades out (focus radii); 0: no rim",
    )

    @model_validator(mode="before")
    @classmethod
    def _named_weights(cls, values: Any) -> Any:
        """Replace a name among `NAMED_WEIGHTS` by its weights."""
        if not isinstance(values, dict) or not isinstance(values.get("weights"), str):
            return values
        name = values["weights"]
        if name not in NAMED_WEIGHTS:
            raise ValueError(
                f"weights is {name!r}; {', '.join(NAMED_WEIGHTS)} or a number per channel is allowed."
            )
        if name == "equal":
            return {**values, "weights": dict.fromkeys(CHANNELS, 1.0)}
        # Channels of plug-ins have no fitted weight.
        fitted = read_fitted_weights()["channels"]
        return {**values, "weights": dict.fromkeys(CHANNELS, 0.0) | fitted}
