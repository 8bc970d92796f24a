"""One colour a face, from the materials and colours of a trimesh mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.meshes.in_memory import GREY


def face_colours(part: Any) -> NDArray[np.uint8]:
    """Give each face its colour.

    Parameters
    ----------
    part : trimesh.Trimesh
        A mesh of f faces.

    Returns
    -------
    numpy.ndarray
        Shape (f, 3), uint8, sRGB: the material's diffuse colour, or the mean of the corners'
        colours; `GREY` where there is none.
    """
    visual, count = part.visual, len(part.faces)
    if visual.kind == "texture":
        return np.tile(np.asarray(visual.material.main_color)[:3].astype(np.uint8), (count, 1))
    if visual.kind == "vertex":
        corners = np.asarray(visual.vertex_colors)[part.faces][..., :3]
        return np.rint(corners.mean(axis=1)).astype(np.uint8)
    if visual.kind == "face":
        return np.asarray(visual.face_colors)[:, :3].astype(np.uint8)
    return np.tile(np.array(GREY, dtype=np.uint8), (count, 1))
