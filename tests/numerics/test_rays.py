"""Rays that meet nothing."""

import numpy as np
from numerics.surfaces import ball

from visuohaptic.geometry.raycasting import MISS, RayCaster
from visuohaptic.stability.rays import everything


def test_a_miss_keeps_no_number_of_a_face():
    origins = np.array([[3.0, 0, 0], [0, 0, 0]])
    directions = np.array([[1.0, 0, 0], [0, 0, 0.0]])
    hits = RayCaster(ball(3)).first_hits(origins, directions, everything)
    # A direction of length 0 goes nowhere and meets nothing.
    assert (hits.face == MISS).all()
    assert np.isinf(hits.distance).all()
