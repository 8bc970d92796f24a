"""The first phase: what an object shows from some viewpoints, and where each strategy would touch it."""

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
from visuohaptic.fixations.probing import strategy_of
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.parameters import VisualModes
from visuohaptic.tables.phases import FIXATIONS, VIEWS, owner_columns
from visuohaptic.tables.schema import build_table

MAP_PIXELS = 64
"""Longer edge, in pixels, of the conspicuity maps that are kept."""


@dataclass(frozen=True, eq=False)
class ObjectViews:
    """What an object shows from its viewpoints; each part is computed when it is asked for.

    Its fields are the object and the phase's arguments, as `pipeline.PHASES` lists them.
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
        """The viewpoints by their numbers."""
        placed = place_cameras(self.viewpoints)
        return {number: placed[number] for number in self.subject.viewpoints}

    @cached_property
    def seen(self) -> Views:
        """The rendered views."""
        cameras = list(self.cameras.values())
        return render_views(self.subject.caster, cameras, self.rendering, self.modes)

    @cached_property
    def looks(self) -> list[AttendedView]:
        """Saliency and fixations of each view."""
        key, caster = self.subject.key, self.subject.caster
        attended = attend(**self.seen.arrays(), parameters=self.attention)
        return [
            AttendedView(key, number, caster, camera, self.seen, place, attended[place])
            for place, (number, camera) in enumerate(self.cameras.items())
        ]

    @property
    def needs_looks(self) -> bool:
        """Whether a strategy needs the views."""
        return any(strategy_of(name).looks for name in self.strategies)

    @cached_property
    def viewpoints_used(self) -> Sequence[Viewpoint]:
        """Where the strategies choose from: looks, or viewpoints alone if none of them looks."""
        if self.needs_looks:
            return self.looks
        key, caster = self.subject.key, self.subject.caster
        return [Viewpoint(key, number, caster, one) for number, one in self.cameras.items()]

    @property
    def fixations(self) -> pa.Table:
        """Where to touch, by every strategy: rows of `tables.FIXATIONS`."""
        tables = [
            locate(one, strategy, self.attention, self.seed)
            for one in self.viewpoints_used
            for strategy in self.strategies
        ]
        return pa.concat_tables([FIXATIONS.arrow.empty_table(), *tables]).combine_chunks()

    @property
    def effects(self) -> pa.Table:
        """Why each effect of the view was needed: rows of `tables.EFFECTS`."""
        first = next(iter(self.cameras))
        return effect_table(self.subject.key, first, "any", self.seen.effects)

    @property
    def views(self) -> pa.Table:
        """The views and their maps as pictures: rows of `tables.VIEWS`."""
        looks = self.looks
        attentions = [one.attended for one in looks]
        eyes = np.stack([one.camera.eye for one in looks])
        columns: dict[str, object] = {
            **owner_columns(self.subject.key),
            "viewpoint": np.array([one.viewpoint for one in looks]),
            "view": [_encode_png(np.rint(view * 255.0)) for view in self.seen.colour],
            "saliency": [_encode_png(np.rint(one.saliency * 255.0)) for one in attentions],
            "conspicuity": [
                [(channel, _encode_map(plane)) for channel, plane in one.conspicuity.items()]
                for one in attentions
            ],
            "skipped": [list(one.skipped.items()) for one in attentions],
            "distinct_fixations": np.array([one.scanpath.distinct for one in attentions]),
        }
        columns |= {f"eye_{axis}": eyes[:, index] for index, axis in enumerate("xyz")}
        return build_table(VIEWS, columns)


def _encode_map(plane: NDArray[np.float32]) -> bytes:
    """Encode a conspicuity map small, its own maximum white."""
    scale = MAP_PIXELS / max(plane.shape)
    small = cv2.resize(plane, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    peak = float(small.max())
    return _encode_png(np.rint(small * (255.0 / peak)) if peak > 0 else small)


def _encode_png(image: NDArray[np.floating]) -> bytes:
    """Encode grey (h, w) or colour (h, w, 3) values of 0 to 255 as PNG."""
    pixels = np.clip(image, 0, 255).astype(np.uint8)
    if pixels.ndim == 3:
        pixels = pixels[..., ::-1]
    _, encoded = cv2.imencode(".png", pixels)
    return bytes(encoded)
