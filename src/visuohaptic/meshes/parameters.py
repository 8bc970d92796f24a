"""Section `meshes` of `params.yaml`."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from visuohaptic.base.section import Section
from visuohaptic.meshes.catalogue import ObjectSet


class MeshParameters(Section):
    """Which objects take part, and how their models are prepared."""

    set: ObjectSet = Field("paper", description="Objects of the catalogue that take part")
    own_up_axis: Literal["y", "z", "auto"] = Field(
        "y",
        description="Axis of own models that points up; with `auto` the one of both on which an object "
        "stands steadier",
    )
    largest_megabytes: float = Field(
        512.0, gt=0, le=1e4, description="Files above this size, unpacked, are refused (MB)"
    )
