"""The eye's part: views of an object, what draws attention in them, and where to touch."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.attention.model import Attention, attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.effect_books import effect_table
from visuohaptic.probing import ProbingLocations, ProbingParameters, draw_by_area
from visuohaptic.raycasting import RayCaster
from visuohaptic.rendering import RenderingParameters, Views, render_views
from visuohaptic.scene import EffectModes
from visuohaptic.seeds import spawn_generator
from visuohaptic.sensor.frames import orient_outwards
from visuohaptic.surface import read_surface
from visuohaptic.tables import EFFECTS, FIXATIONS, VIEWS, build_table, write_table
from visuohaptic.viewpoints import Camera, ViewpointParameters, place_cameras

MAP_PIXELS = 64
"""Longer edge, in pixels, of the conspicuity maps that are kept."""


def make_fixations(
    key: str,
    mesh: str | Path,
    fixations: str | Path,
    views: str | Path,
    effects: str | Path,
    block: Sequence[int],
    viewpoints: ViewpointParameters,
    rendering: RenderingParameters,
    attention: AttentionParameters,
    probing: ProbingParameters,
    modes: EffectModes,
    seed: int,
) -> None:
    """Make the view and fixation tables of one object and a block of its viewpoints.

    The books of the effects of the view come with them.

    Parameters
    ----------
    key : str
        `class/name` of the object.
    mesh : path
        Its surface.
    fixations, views, effects : path
        The Parquet files to write.
    block : sequence of int
        Numbers of the viewpoints; what a viewpoint gives does not depend on the others.
    viewpoints, rendering, attention, probing
        Sections of the parameters.
    modes : EffectModes
        When the effects of the view are simulated; all others have no say.
    seed : int
        The experiment's seed.
    """
    caster = RayCaster(read_surface(mesh))
    placed = place_cameras(viewpoints)
    cameras = {number: placed[number] for number in block}
    seen = render_views(caster, list(cameras.values()), rendering, modes)
    attentions = attend(
        colour=seen.colour,
        mask=seen.mask,
        point=seen.point,
        normal=seen.normal,
        face=seen.face,
        curvature=seen.curvature,
        parameters=attention,
    )
    write_table(VIEWS, _view_table(key, cameras, seen, attentions), views)
    write_table(EFFECTS, effect_table(key, block[0], "any", seen.effects), effects)
    tables = []
    for number, attended in zip(block, attentions, strict=True):
        if "fixation" in probing.strategies:
            tables.append(_fixation_table(key, number, attended))
        if "random" in probing.strategies:
            generator = spawn_generator(seed, "random", key, number)
            drawn = draw_by_area(caster.surface, attention.fixations, generator)
            tables.append(_drawn_table(key, number, "random", caster, drawn))
    write_table(FIXATIONS, pa.concat_tables(tables), fixations)


def _view_table(
    key: str, cameras: dict[int, Camera], seen: Views, attentions: Sequence[Attention]
) -> pa.Table:
    category, name = key.split("/")
    eyes = np.stack([camera.eye for camera in cameras.values()])
    columns: dict[str, object] = {
        "class": category,
        "object": name,
        "viewpoint": np.array(list(cameras)),
        "view": [_encode_png(np.rint(view * 255.0)) for view in seen.colour],
        "saliency": [_encode_png(np.rint(attended.saliency * 255.0)) for attended in attentions],
        "conspicuity": [
            [(channel, _encode_map(plane)) for channel, plane in attended.conspicuity.items()]
            for attended in attentions
        ],
        "skipped": [list(attended.skipped.items()) for attended in attentions],
        "distinct_fixations": np.array([attended.scanpath.distinct for attended in attentions]),
    }
    columns |= {f"eye_{axis}": eyes[:, index] for index, axis in enumerate("xyz")}
    return build_table(VIEWS, columns)


def _fixation_table(key: str, viewpoint: int, attended: Attention) -> pa.Table:
    path = attended.scanpath
    return _location_table(
        key,
        viewpoint,
        "fixation",
        ProbingLocations(path.points, path.normals, path.faces),
        {"pixel_row": path.rows, "pixel_column": path.columns, "saliency": path.saliency},
    )


def _drawn_table(
    key: str, viewpoint: int, strategy: str, caster: RayCaster, drawn: ProbingLocations
) -> pa.Table:
    outwards = orient_outwards(caster, drawn.points, drawn.normals)
    blind = [None] * len(drawn.points)
    return _location_table(
        key,
        viewpoint,
        strategy,
        ProbingLocations(drawn.points, outwards, drawn.faces),
        {"pixel_row": blind, "pixel_column": blind, "saliency": blind},
    )


def _location_table(
    key: str,
    viewpoint: int,
    strategy: str,
    locations: ProbingLocations,
    looked: dict[str, object],
) -> pa.Table:
    category, name = key.split("/")
    columns: dict[str, object] = {
        "class": category,
        "object": name,
        "viewpoint": viewpoint,
        "strategy": strategy,
        "touch": np.arange(len(locations.points)),
        "face": locations.faces,
        **looked,
    }
    for index, axis in enumerate("xyz"):
        columns[axis] = locations.points[:, index]
        columns[f"normal_{axis}"] = locations.normals[:, index]
    return build_table(FIXATIONS, columns)


def _encode_map(plane: NDArray[np.float32]) -> bytes:
    """Encode a conspicuity map small, its own maximum white."""
    import cv2

    scale = MAP_PIXELS / max(plane.shape)
    small = cv2.resize(plane, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    peak = float(small.max())
    return _encode_png(np.rint(small * (255.0 / peak)) if peak > 0 else small)


def _encode_png(image: NDArray[np.floating]) -> bytes:
    """Encode grey (h, w) or colour (h, w, 3) values of 0 to 255 as PNG."""
    import cv2

    pixels = np.clip(image, 0, 255).astype(np.uint8)
    if pixels.ndim == 3:
        pixels = pixels[..., ::-1]
    _, encoded = cv2.imencode(".png", pixels)
    return bytes(encoded)
