"""Section `gaze` of `params.yaml`."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

GAZE_SUFFIXES = (".txt", ".npz")
"""How files of recorded gaze end."""


class GazeParameters(BaseModel):
    """Where recordings of people's gaze are, and how attention is compared with them."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    folder: str = Field(
        "",
        description="Folder with recorded gaze and meshes; without one, attention is not compared",
    )
    peer: str = Field(
        "",
        description="Folder with predictions of others for the same objects, compared beside ours",
    )
    largest_megabytes: float = Field(
        64.0, gt=0, le=1e4, description="Files of recorded gaze above this size are refused (MB)"
    )
    spread: float = Field(
        0.04,
        gt=0,
        le=1,
        description="Standard deviation of the Gaussian that spreads recorded gaze over the surface (object radii)",
    )
    largest_error: float = Field(
        0.03,
        gt=0,
        le=1,
        description="Recordings are refused if a twentieth of their points lie farther off the mesh (object radii)",
    )
    folds: int = Field(
        6,
        ge=2,
        le=100,
        description="Parts of the objects that are held out in turn when weights are fitted",
    )
    penalty: float = Field(
        0.001, ge=0, description="Penalty on the squared weights of standardised features"
    )
