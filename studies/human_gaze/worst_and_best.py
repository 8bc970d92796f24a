"""Pictures of recorded objects: where people looked, where they were predicted to, and the floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pyarrow as pa
from scipy.spatial import cKDTree

from human_gaze.gazed_objects import GazedObject, GazeSettings
from human_gaze.predicting import BY_NAME, predict, weights_of
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster

WORST, BEST = 6, 3
RESOLUTION = 192
PANELS = ("human", "centre")
"""Predictors beside people's own time, from left to right."""

# The largest value of the colour scale, as a quantile over the points, so that one place does not
# leave all others dark.
_TOP_QUANTILE = 0.98


def draw_worst_and_best(
    objects: Sequence[GazedObject],
    table: pa.Table,
    viewpoints: ViewpointParameters,
    settings: GazeSettings,
    folder: str | Path,
) -> None:
    """Draw the objects on which predictor ``human`` is worst and best, as ``<rank>_<object>.png`` in a folder.

    From left to right: people's time, the prediction, and nearness to the middle of the view; yellow is most.
    Rank 0 is the object with the lowest correlation.
    """
    found = {
        row["object"]: row["correlation"]
        for row in table.to_pylist()
        if row["predictor"] == "human"
    }
    order = sorted(found, key=lambda name: (found[name], name))
    ranks = dict.fromkeys([*range(len(order))[:WORST], *range(len(order))[-BEST:]])
    by_name = {one.name: one for one in objects}
    weights = {name: weights_of(objects, BY_NAME[name], settings) for name in PANELS}
    for rank in ranks:
        one = by_name[order[rank]]
        values = [predict(one, BY_NAME[name], weights[name][one.name]) for name in PANELS]
        drawn = draw_values(one, [one.gazed.density, *values], viewpoints)
        with atomic_file(Path(folder, f"{rank:03d}_{one.name}.png")) as unfinished:
            unfinished.write_bytes(drawn)


def draw_values(
    one: GazedObject, values: Sequence[FloatArray], viewpoints: ViewpointParameters
) -> bytes:
    """Draw an object once for each array of values at its points, side by side, as PNG.

    It is seen from the viewpoint that shows most of people's time.
    """
    time = one.gazed.density * one.gazed.area
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
