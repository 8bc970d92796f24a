"""The eye's part: views of an object, what draws attention in them, and where to touch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.attention.model import Attention, attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.effect_books import effect_table
from visuohaptic.probing import (
    STRATEGIES,
    ProbingLocations,
    ProbingParameters,
    sees,
    turn_towards,
)
from visuohaptic.raycasting import RayCaster
from visuohaptic.rendering import RenderingParameters, Views, render_views
from visuohaptic.scene import EffectModes
from visuohaptic.seeds import spawn_generator
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
    looks = look(caster, key, cameras, rendering, attention, modes)
    seen, attentions = looks[0].seen, [one.attended for one in looks]
    write_table(VIEWS, _view_table(key, cameras, seen, attentions), views)
    write_table(EFFECTS, effect_table(key, block[0], "any", seen.effects), effects)
    tables = [
        locate(one, strategy, attention, seed) for one in looks for strategy in probing.strategies
    ]
    write_table(FIXATIONS, pa.concat_tables(tables), fixations)


@dataclass(frozen=True)
class Look:
    """One viewpoint of an object, and what the eye makes of it.

    Attributes
    ----------
    key : str
        `class/name` of the object.
    viewpoint : int
        Number of the viewpoint.
    caster : RayCaster
        The object.
    camera : Camera
        The viewpoint.
    seen : Views
        The views of all viewpoints that were looked from together.
    place : int
        Which of these views is this one's.
    attended : Attention
        What drew the eye.
    """

    key: str
    viewpoint: int
    caster: RayCaster
    camera: Camera
    seen: Views
    place: int
    attended: Attention


def look(
    caster: RayCaster,
    key: str,
    cameras: Mapping[int, Camera],
    rendering: RenderingParameters,
    attention: AttentionParameters,
    modes: EffectModes,
) -> list[Look]:
    """Look at an object from several viewpoints.

    Parameters
    ----------
    caster : RayCaster
        The object.
    key : str
        `class/name` of the object.
    cameras : mapping of int to Camera
        Viewpoints by their numbers; none changes what another gives.
    rendering, attention
        Sections of the parameters.
    modes : EffectModes
        When the effects of the view are simulated.

    Returns
    -------
    list of Look
        One a viewpoint.
    """
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
    return [
        Look(key, number, caster, camera, seen, place, attentions[place])
        for place, (number, camera) in enumerate(cameras.items())
    ]


def locate(one: Look, strategy: str, attention: AttentionParameters, seed: int) -> pa.Table:
    """Choose where to touch.

    Parameters
    ----------
    one : Look
        The viewpoint.
    strategy : str
        One of `probing.STRATEGIES`.
    attention : AttentionParameters
        How many touches, and how far apart the eye keeps them.
    seed : int
        The experiment's seed; what is drawn depends on it, the strategy, the object and the
        viewpoint alone.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.FIXATIONS`: as many as fixations are asked for, or fewer where
        the view has no more.

    Raises
    ------
    RegistryError
        If there is no such strategy.
    """
    chosen = STRATEGIES[strategy].choose(
        one, attention, spawn_generator(seed, strategy, one.key, one.viewpoint)
    )
    if isinstance(chosen, ProbingLocations):
        return _location_table(one, strategy, chosen, _blind(chosen))
    return _path_table(one, strategy, chosen)


def candidate_table(one: Look, crowd: ProbingLocations) -> pa.Table:
    """List those of an object's points that a viewpoint sees, for `adaptive` to choose among.

    Parameters
    ----------
    one : Look
        The viewpoint.
    crowd : ProbingLocations
        Points of the object, the same for all its viewpoints.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.FIXATIONS` of strategy ``adaptive``, in the crowd's order.
    """
    shown = crowd.take(np.flatnonzero(sees(one.caster, one.camera, crowd.points)))
    return _location_table(one, "adaptive", turn_towards(shown, one.camera), _blind(shown))


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


def _path_table(one: Look, strategy: str, path: Scanpath) -> pa.Table:
    pixels = {"pixel_row": path.rows, "pixel_column": path.columns, "saliency": path.saliency}
    locations = ProbingLocations(path.points, path.normals, path.faces)
    return _location_table(one, strategy, locations, pixels)


def _blind(drawn: ProbingLocations) -> dict[str, object]:
    """No pixel was chosen, so there is none to name."""
    return {name: [None] * len(drawn.faces) for name in ("pixel_row", "pixel_column", "saliency")}


def _location_table(
    one: Look, strategy: str, locations: ProbingLocations, looked: Mapping[str, object]
) -> pa.Table:
    category, name = one.key.split("/")
    columns: dict[str, object] = {
        "class": category,
        "object": name,
        "viewpoint": one.viewpoint,
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
