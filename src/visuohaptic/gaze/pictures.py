"""Pictures of recorded objects: where people looked, where they were predicted to, and the floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pyarrow as pa

from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.gaze.looking import GazedObject
from visuohaptic.gaze.parameters import GazeParameters
from visuohaptic.gaze.predicting import BY_NAME, predict, weights_of
from visuohaptic.geometry.arrays import Floats
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.tables.gaze import GAZE_PICTURES
from visuohaptic.tables.schema import build_table

WORST, BEST = 6, 3
RESOLUTION = 192
PANELS = ("human", "centre")
"""Predictors beside people's own time, from left to right."""

# The largest value of the colour scale, as a quantile over the points, so that one place does not
# leave all others dark.
_TOP_QUANTILE = 0.98


def picture_table(
    objects: Sequence[GazedObject], table: pa.Table, gaze: GazeParameters
) -> pa.Table:
    """Draw the objects on which predictor ``human`` is worst and best: rows of `GAZE_PICTURES`."""
    found = {
        row["object"]: row["correlation"]
        for row in table.to_pylist()
        if row["predictor"] == "human"
    }
    order = sorted(found, key=lambda name: (found[name], name))
    ranks = dict.fromkeys([*range(len(order))[:WORST], *range(len(order))[-BEST:]])
    by_name = {one.name: one for one in objects}
    weights = {name: weights_of(objects, BY_NAME[name], gaze) for name in PANELS}
    pictures = []
    for rank in ranks:
        one = by_name[order[rank]]
        values = [predict(one, BY_NAME[name], weights[name][one.name]) for name in PANELS]
        pictures.append(draw_values(one, [one.gazed.density, *values]))
    return build_table(
        GAZE_PICTURES,
        {
            "object": [order[rank] for rank in ranks],
            "rank": np.array(list(ranks), dtype=np.int32),
            "correlation": [found[order[rank]] for rank in ranks],
            "picture": pictures,
        },
    )


def draw_values(one: GazedObject, values: Sequence[Floats]) -> bytes:
    """Draw an object once for each array of values at its points, side by side, as PNG.

    It is seen from the viewpoint of the default ring that shows most of people's time.
    """
    import cv2
    from scipy.spatial import cKDTree

    time = one.gazed.density * one.gazed.area
    viewpoints = ViewpointParameters(count=len(one.visible))
    camera = place_cameras(viewpoints)[int((one.visible @ time).argmax())]
    _, nearest = cKDTree(one.points).query(one.surface.triangles.mean(axis=1))
    panels = []
    for value in values:
        top = max(float(np.quantile(value[one.gazed.seen], _TOP_QUANTILE)), 1e-30)
        levels = np.clip(np.rint(255 * value / top), 0, 255).astype(np.uint8)[:, None]
        colours = cv2.applyColorMap(levels, cv2.COLORMAP_VIRIDIS)[:, 0, ::-1]
        painted = replace(
            one.surface, face_colours=np.ascontiguousarray(colours[nearest]), texture=None
        )
        rendering = RenderingParameters(resolution=RESOLUTION, background=1.0)
        (seen,) = render_views(RayCaster(painted), [camera], rendering).colour
        panels.append(np.clip(np.rint(seen[..., ::-1] * 255), 0, 255).astype(np.uint8))
    _, encoded = cv2.imencode(".png", np.concatenate(panels, axis=1))
    return bytes(encoded)
