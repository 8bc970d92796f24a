"""Section `meshes` of `params.yaml`."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from visuohaptic.meshes.catalogue import ObjectSet


class MeshParameters(BaseModel):
    """Section `meshes` of `params.yaml`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    set: ObjectSet = Field("paper", description="which objects of the catalogue take part")
    merge_tolerance: float = Field(
        1e-6, ge=0, le=1e-3, description="vertices nearer than this become one, in object radii"
    )
    own_up_axis: str = Field(
        "y", pattern="^[yz]$", description="which axis of own models points up"
    )
    largest_megabytes: float = Field(
        512.0, gt=0, description="own files above this are refused, in MB"
    )
