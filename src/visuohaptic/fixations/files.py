"""From meshes to the view and fixation tables of a block of viewpoints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.locations import Look, locate_all, look
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface, set_aside_reason
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.parameters import EffectModes
from visuohaptic.tables.phases import EFFECTS, FIXATIONS, VIEWS, owner_columns
from visuohaptic.tables.schema import build_table, write_table

MAP_PIXELS = 64
"""Longer edge, in pixels, of the conspicuity maps that are kept."""


def make_fixations(
    meshes: Mapping[str, str | Path],
    fixations: str | Path,
    views: str | Path,
    effects: str | Path,
    block: Sequence[int],
    viewpoints: ViewpointParameters,
    rendering: RenderingParameters,
    attention: AttentionParameters,
    strategies: Sequence[str],
    modes: EffectModes,
    seed: int,
) -> None:
    """Make the view, fixation and effect log tables of some objects, by `class/name`, and a block of their viewpoints.

    An object that was set aside has no rows.
    """
    placed = place_cameras(viewpoints)
    cameras = {number: placed[number] for number in block}

    def tables_of_objects() -> Iterator[tuple[pa.Table, ...]]:
        yield tuple(schema.arrow.empty_table() for schema in (VIEWS, EFFECTS, FIXATIONS))
        for key, mesh in meshes.items():
            if not set_aside_reason(mesh):
                caster = RayCaster(read_surface(mesh))
                looks = look(caster, key, cameras, rendering, attention, modes)
                located = locate_all(looks, strategies, attention, seed)
                yield *view_tables(looks), located

    pictures, logs, locations = zip(*tables_of_objects(), strict=True)
    write_table(VIEWS, pa.concat_tables(pictures), views)
    write_table(EFFECTS, pa.concat_tables(logs), effects)
    write_table(FIXATIONS, pa.concat_tables(locations), fixations)


def view_tables(looks: Sequence[Look]) -> tuple[pa.Table, pa.Table]:
    """Give what one call of `look` saw: rows of `tables.VIEWS` and of `tables.EFFECTS`."""
    first = looks[0]
    log = effect_table(first.key, first.viewpoint, "any", first.seen.effects)
    attentions = [one.attended for one in looks]
    eyes = np.stack([one.camera.eye for one in looks])
    columns: dict[str, object] = {
        **owner_columns(first.key),
        "viewpoint": np.array([one.viewpoint for one in looks]),
        "view": [_encode_png(np.rint(view * 255.0)) for view in first.seen.colour],
        "saliency": [_encode_png(np.rint(attended.saliency * 255.0)) for attended in attentions],
        "conspicuity": [
            [(channel, _encode_map(plane)) for channel, plane in attended.conspicuity.items()]
            for attended in attentions
        ],
        "skipped": [list(attended.skipped.items()) for attended in attentions],
        "distinct_fixations": np.array([attended.scanpath.distinct for attended in attentions]),
    }
    columns |= {f"eye_{axis}": eyes[:, index] for index, axis in enumerate("xyz")}
    return build_table(VIEWS, columns), log


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
