"""Strategy `random`: locations uniform by area over the surface."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import ProbingLocations, draw_by_area


def choose(
    viewpoint: Viewpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Draw locations over the whole surface, including hidden parts."""
    return draw_by_area(viewpoint.caster.surface, attention.fixations, generator)
