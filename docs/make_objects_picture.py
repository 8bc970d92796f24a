"""Draw the picture of docs/your_objects.md: two objects that stand well, and two that do not."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import visuohaptic as vh
from visuohaptic.exploration.standing import draw_standing, join_cells
from visuohaptic.geometry.turning import turn_surface
from visuohaptic.parameters import ExperimentParameters

PICTURE = Path(__file__).parent / "pictures" / "standing.png"
UPRIGHT = np.eye(3)
# As a file with z up that is read with y up.
LYING = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
FACING_X = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
CELLS = {
    "chair/stands well": UPRIGHT,
    "car/stands well": UPRIGHT,
    "chair/lies: z is up in its file": LYING,
    "car/faces the side": FACING_X,
}


if __name__ == "__main__":
    cells = [
        draw_standing(
            key, turn_surface(vh.example(key.split("/")[0]).surface, turn), ExperimentParameters()
        )
        for key, turn in CELLS.items()
    ]
    join_cells(cells).save(PICTURE, optimize=True)
