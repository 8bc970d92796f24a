"""Section `meshes` of `params.yaml`."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from visuohaptic.base.section import Section
from visuohaptic.geometry.turning import Turns
from visuohaptic.meshes.catalogue import ObjectSet
from visuohaptic.meshes.up_axis import Axis, are_perpendicular


class MeshParameters(Section):
    """The set of objects, and the preparation of their models."""

    set: ObjectSet = Field(
        "paper",
        description="Set of objects of the catalogue, beside which own models take part; `own`: own models only",
    )
    own_up_axis: Literal["file", "auto", "x", "-x", "y", "-y", "z", "-z"] = Field(
        "file",
        description="Up axis of own models, such as z or -y; `file`: as the file says (glTF, COLLADA, 3MF), else y; "
        "`auto`: y or z, the axis on which the object stands more steadily",
    )
    own_front_axis: Axis | None = Field(
        None,
        description="Front axis of own models, such as x or -z, perpendicular to the up axis; null: z, for up axis z "
        "it is -y, and for -z it is y",
    )
    turns: Turns = Field(
        "none",
        description="Random turn of each object before the views: none, about the vertical, or in any "
        "direction; the random seed and the object's name decide the turn",
    )
    turn_draw: int = Field(0, ge=0, description="Index of the draw of the random turns")
    largest_megabytes: float = Field(
        512.0, gt=0, le=1e4, description="Largest size of a model file, unpacked (MB)"
    )

    @model_validator(mode="after")
    def _front_is_perpendicular_to_up(self) -> Self:
        up, front = self.own_up_axis, self.own_front_axis
        if up not in {"file", "auto"} and front and not are_perpendicular(up, front):
            raise ValueError(
                f"own_up_axis is {up} and own_front_axis is {front}; perpendicular axes are needed"
            )
        return self
