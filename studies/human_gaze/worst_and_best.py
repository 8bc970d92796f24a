"""Draw recorded objects with the time that people looked, the prediction, and the floor."""

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
"""Predictors that are drawn to the right of people's time, from left to right."""

# Quantile over the points that has the largest colour, so that one bright point does not darken all others.
_TOP_QUANTILE = 0.98


def draw_worst_and_best(
    objects: Sequence[GazedObject],
    table: pa.Table,
    viewpoints: ViewpointParameters,
    settings: GazeSettings,
    folder: str | Path,
) -> None:
    """Write pictures ``<rank>_<object>.png`` of the objects on which predictor ``human`` is worst and best.

    Rank 0 has the lowest correlation in `table`, rows of `AGREEMENT`. From left to right, a picture shows people's time,
    the prediction, and nearness to the middle of the view; yellow is the largest value.
    """
    correlation_of = {
        row["object"]: row["correlation"]
        for row in table.to_pylist()
        if row["predictor"] == "human"
    }
    order = sorted(correlation_of, key=lambda name: (correlation_of[name], name))
    ranks = dict.fromkeys([*range(len(order))[:WORST], *range(len(order))[-BEST:]])
    by_name = {gazed.name: gazed for gazed in objects}
    weights = {name: weights_of(objects, BY_NAME[name], settings) for name in PANELS}
    for rank in ranks:
        gazed = by_name[order[rank]]
        values = [predict(gazed, BY_NAME[name], weights[name][gazed.name]) for name in PANELS]
        picture = draw_values(gazed, [gazed.gazed.density, *values], viewpoints)
        with atomic_file(Path(folder, f"{rank:03d}_{gazed.name}.png")) as unfinished:
            unfinished.write_bytes(picture)


def draw_values(
    gazed: GazedObject, values: Sequence[FloatArray], viewpoints: ViewpointParameters
) -> bytes:
    """Draw an object once per array of values (n,) at its points, side by side; return the picture as PNG.

    The view is from the viewpoint that shows most of people's time.
    """
    time = gazed.gazed.density * gazed.gazed.area
    camera = place_cameras(viewpoints)[int((gazed.visible @ time).argmax())]
    _, nearest = cKDTree(gazed.points).query(gazed.surface.triangles.mean(axis=1))
    panels = []
    for value in values:
        top = max(float(np.quantile(value[gazed.gazed.seen], _TOP_QUANTILE)), 1e-30)
        levels = np.clip(np.rint(255 * value / top), 0, 255).astype(np.uint8)[:, None]
        colours = cv2.applyColorMap(levels, cv2.COLORMAP_VIRIDIS)[:, 0, ::-1]
        painted = replace(
            gazed.surface, face_colours=np.ascontiguousarray(colours[nearest]), texture=None
        )
        rendering = RenderingParameters(resolution=RESOLUTION, background=1.0)
        (seen,) = render_views(RayCaster(painted), [camera], rendering).colour
        panels.append(np.clip(np.rint(seen[..., ::-1] * 255), 0, 255).astype(np.uint8))
    _, encoded = cv2.imencode(".png", np.concatenate(panels, axis=1))
    return bytes(encoded)
