"""Section `meshes` of `params.yaml`."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from visuohaptic.base.section import Section
from visuohaptic.geometry.turning import Turns
from visuohaptic.meshes.catalogue import ObjectSet


class MeshParameters(Section):
    """Which objects take part, and how their models are prepared."""

    set: ObjectSet = Field("paper", description="Objects of the catalogue that take part")
    own_up_axis: Literal["file", "y", "z", "auto"] = Field(
        "file",
        description="Axis of own models that points up: `file`: as the file says (glTF, COLLADA, 3MF), else y; "
        "`auto`: the one of y and z on which an object stands steadier",
    )
    turns: Turns = Field(
        "none",
        description="How each object is turned before it is looked at and touched: not, about the vertical, or in any "
        "way, by the random seed and its name",
    )
    turn_draw: int = Field(0, ge=0, description="Index of the draw of the turns")
    largest_megabytes: float = Field(
        512.0, gt=0, le=1e4, description="Files above this size, unpacked, are refused (MB)"
    )
