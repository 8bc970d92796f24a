"""Where to touch when the eye does not say: strategies that attention is compared with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

if TYPE_CHECKING:
    from visuohaptic.surface import Surface

Strategy = Literal["fixation", "random"]


class ProbingParameters(BaseModel):
    """Section `probing` of `params.yaml`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    strategies: tuple[Strategy, ...] = Field(
        ("fixation", "random"), min_length=1, description="how probing locations are chosen"
    )


@dataclass(frozen=True)
class ProbingLocations:
    """Points to touch, in order.

    Attributes
    ----------
    points : numpy.ndarray
        Shape (n, 3), float64, object frame.
    normals : numpy.ndarray
        Shape (n, 3), float64: unit normals, by the winding of the face.
    faces : numpy.ndarray
        Shape (n,), int64: the face on which each point lies.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    faces: NDArray[np.int64]


def draw_by_area(surface: Surface, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Draw points uniformly over a surface, by area.

    Parameters
    ----------
    surface : Surface
        The object.
    count : int
        How many points.
    generator : numpy.random.Generator
        Where chance comes from.

    Returns
    -------
    ProbingLocations
        `count` points; hidden parts of the surface are as likely as visible ones.

    Notes
    -----
    A triangle is drawn by its share of the area, a point in it by the square-root
    map of the unit square (Osada et al., ACM Trans. Graph. 21(4), 2002, eq. 1).
    """
    cumulative = np.cumsum(surface.face_areas)
    faces = np.searchsorted(cumulative, generator.random(count) * cumulative[-1], side="right")
    faces = np.minimum(faces, len(cumulative) - 1)
    root, along = np.sqrt(generator.random(count)), generator.random(count)
    weights = np.column_stack([1 - root, root * (1 - along), root * along])
    points = np.einsum("nc,nck->nk", weights, surface.triangles[faces])
    return ProbingLocations(points, surface.face_normals[faces], faces)
