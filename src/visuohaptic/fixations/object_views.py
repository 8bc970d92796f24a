"""Phase `fixations` of one object: its views, and the probing locations of every strategy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.attended_views import AttendedView, Viewpoint
from visuohaptic.fixations.locations import locate
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.probing import PLANNED, entry_of
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.parameters import VisualModes
from visuohaptic.scene.records import EffectRecord, merge_records
from visuohaptic.tables.phases import VIEWS, owner_columns
from visuohaptic.tables.schema import build_table

MAP_PIXELS = 64
"""Longer edge to which conspicuity maps are resized for storing, pixels."""


@dataclass(frozen=True, eq=False)
class ObjectViews:
    """Views and probing locations of one object: the results of phase `fixations`.

    `cameras`, `rendered`, `attended_views` and `strategy_inputs` are computed on first use and kept. The tables
    `fixations`, `effects` and `views` are built anew at each access.

    Attributes
    ----------
    subject : Subject
        The object, and the numbers of at least one viewpoint of the arrangement.
    viewpoints : ViewpointParameters
        The arrangement of cameras; `subject.viewpoints` selects from it.
    rendering : RenderingParameters
        Resolution, light and background.
    attention : AttentionParameters
        Parameters of the saliency map, and number of fixations.
    strategies : tuple of str
        Names of strategies, or of draws of strategies, without policies.
    modes : VisualModes
        When each visual effect is simulated.
    seed : int
        Seed of the run.
    """

    subject: Subject
    viewpoints: ViewpointParameters
    rendering: RenderingParameters
    attention: AttentionParameters
    strategies: tuple[str, ...]
    modes: VisualModes
    seed: int

    @cached_property
    def cameras(self) -> dict[int, Camera]:
        """The camera of each viewpoint of `subject`, by number of the viewpoint."""
        cameras = place_cameras(self.viewpoints)
        return {number: cameras[number] for number in self.subject.viewpoints}

    @cached_property
    def rendered(self) -> Views:
        """One rendered view per camera, in the order of `cameras`."""
        cameras = list(self.cameras.values())
        return render_views(self.subject.caster, cameras, self.rendering, self.modes)

    @cached_property
    def attended_views(self) -> list[AttendedView]:
        """Each view with the saliency map and fixations of the attention model, in the order of `cameras`."""
        key, caster, views = self.subject.key, self.subject.caster, self.rendered
        attended = attend(**views.attend_arguments(), parameters=self.attention)
        return [
            AttendedView(key, number, caster, camera, views, index, attended[index])
            for index, (number, camera) in enumerate(self.cameras.items())
        ]

    @property
    def needs_views(self) -> bool:
        """Whether any of the strategies needs rendered views; without them `fixations` renders none."""
        return any(entry_of(PLANNED, name).needs_view for name in self.strategies)

    @cached_property
    def strategy_inputs(self) -> Sequence[Viewpoint]:
        """One input of the strategies per camera: `attended_views` if `needs_views`, otherwise viewpoints only."""
        if self.needs_views:
            return self.attended_views
        key, caster = self.subject.key, self.subject.caster
        return [Viewpoint(key, number, caster, camera) for number, camera in self.cameras.items()]

    @property
    def fixations(self) -> pa.Table:
        """The probing locations of every strategy: rows of `tables.FIXATIONS`.

        Each viewpoint and strategy has up to `tables.phases.SPARE` locations more than `attention.fixations`. Rows
        are in the order of viewpoints, then strategies. Raises `RegistryError` if a name is unknown, or the name of a
        policy.
        """
        return locate(self.strategy_inputs, self.strategies, self.attention, self.seed)

    @property
    def effects(self) -> pa.Table:
        """The record of each visual effect, summed over all views: rows of `tables.EFFECTS`; renders the views."""
        first = next(iter(self.cameras))
        return effect_table(self.subject.key, first, "any", self.rendered.effects)

    @property
    def views(self) -> pa.Table:
        """One row of `tables.VIEWS` per viewpoint: view and maps as PNG, camera centre, number of fixations.

        Renders the views, even if no strategy needs them.
        """
        attentions = [view.attended for view in self.attended_views]
        eyes = np.stack([camera.eye for camera in self.cameras.values()])
        columns: dict[str, object] = {
            **owner_columns(self.subject.key),
            "viewpoint": np.array(list(self.cameras)),
            "view": [_encode_png(np.rint(view * 255.0)) for view in self.rendered.colour],
            "saliency": [_encode_png(np.rint(each.saliency * 255.0)) for each in attentions],
            "conspicuity": [
                [(channel, _encode_map(plane)) for channel, plane in each.conspicuity.items()]
                for each in attentions
            ],
            "skipped": [list(each.skipped.items()) for each in attentions],
            "distinct_fixations": np.array([each.scanpath.distinct for each in attentions]),
        }
        columns |= {f"eye_{axis}": eyes[:, index] for index, axis in enumerate("xyz")}
        return build_table(VIEWS, columns)


@dataclass(frozen=True, eq=False)
class ViewTables:
    """The tables `fixations`, `effects` and `views` of `ObjectViews`."""

    fixations: pa.Table
    effects: pa.Table
    views: pa.Table


def look(
    subject: Subject,
    viewpoints: ViewpointParameters,
    rendering: RenderingParameters,
    attention: AttentionParameters,
    strategies: tuple[str, ...],
    modes: VisualModes,
    seed: int,
) -> ViewTables:
    """Return the tables of `ObjectViews`, with at most `rendering.views_at_once` views in memory.

    The arguments are the attributes of `ObjectViews`.
    """
    fixations: list[pa.Table] = []
    views: list[pa.Table] = []
    records: list[tuple[EffectRecord, ...]] = []
    for block in subject.blocks(rendering.views_at_once):
        seen = ObjectViews(block, viewpoints, rendering, attention, strategies, modes, seed)
        fixations.append(seen.fixations)
        views.append(seen.views)
        records.append(seen.rendered.effects)
    effects = effect_table(subject.key, subject.viewpoints[0], "any", merge_records(records))
    return ViewTables(pa.concat_tables(fixations), effects, pa.concat_tables(views))


def _encode_map(plane: NDArray[np.float32]) -> bytes:
    """Resize a conspicuity map (h, w) to `MAP_PIXELS` and encode it as PNG; its largest value, if above 0, is white."""
    scale = MAP_PIXELS / max(plane.shape)
    small = cv2.resize(plane, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    peak = float(small.max())
    return _encode_png(np.rint(small * (255.0 / peak)) if peak > 0 else small)


def _encode_png(image: NDArray[np.floating]) -> bytes:
    """Encode grey (h, w) or RGB (h, w, 3) values as 8-bit PNG: clipped to 0 to 255, decimals cut off."""
    pixels = np.clip(image, 0, 255).astype(np.uint8)
    if pixels.ndim == 3:
        # OpenCV expects blue first.
        pixels = pixels[..., ::-1]
    _, encoded = cv2.imencode(".png", pixels)
    return bytes(encoded)
