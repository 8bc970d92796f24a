"""Section `meshes` of `params.yaml`."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from visuohaptic.base.section import Section
from visuohaptic.geometry.turning import Turns
from visuohaptic.meshes.catalogue import ObjectSet


class MeshParameters(Section):
    """The set of objects, and the preparation of their models."""

    set: ObjectSet = Field("paper", description="Set of objects of the catalogue")
    own_up_axis: Literal["file", "y", "z", "auto"] = Field(
        "file",
        description="Up axis of own models: `file`: as the file says (glTF, COLLADA, 3MF), else y; "
        "`auto`: y or z, the axis on which the object stands more steadily",
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
