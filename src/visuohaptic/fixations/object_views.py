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
from visuohaptic.fixations.probing import strategy_of
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.parameters import VisualModes
from visuohaptic.tables.phases import FIXATIONS, VIEWS, owner_columns
from visuohaptic.tables.schema import build_table

MAP_PIXELS = 64
"""Longer edge of the stored conspicuity maps, pixels."""


@dataclass(frozen=True, eq=False)
class ObjectViews:
    """The results of phase `fixations` for one object; each is computed on first use.

    The fields are the object and the phase's arguments, as in `phases.PHASES`.
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
        """The cameras by number of the viewpoint."""
        cameras = place_cameras(self.viewpoints)
        return {number: cameras[number] for number in self.subject.viewpoints}

    @cached_property
    def rendered(self) -> Views:
        """The rendered views."""
        cameras = list(self.cameras.values())
        return render_views(self.subject.caster, cameras, self.rendering, self.modes)

    @cached_property
    def attended_views(self) -> list[AttendedView]:
        """Each view with its saliency and fixations."""
        key, caster, views = self.subject.key, self.subject.caster, self.rendered
        attended = attend(**views.arrays(), parameters=self.attention)
        return [
            AttendedView(key, number, caster, camera, views, index, attended[index])
            for index, (number, camera) in enumerate(self.cameras.items())
        ]

    @property
    def needs_views(self) -> bool:
        """Whether any strategy needs the views."""
        return any(strategy_of(name).looks for name in self.strategies)

    @cached_property
    def viewpoints_used(self) -> Sequence[Viewpoint]:
        """The input of the strategies: attended views if any strategy needs views, otherwise viewpoints."""
        if self.needs_views:
            return self.attended_views
        key, caster = self.subject.key, self.subject.caster
        return [Viewpoint(key, number, caster, camera) for number, camera in self.cameras.items()]

    @property
    def fixations(self) -> pa.Table:
        """The probing locations of every strategy: rows of `tables.FIXATIONS`."""
        tables = [
            locate(viewpoint, strategy, self.attention, self.seed)
            for viewpoint in self.viewpoints_used
            for strategy in self.strategies
        ]
        return pa.concat_tables([FIXATIONS.arrow.empty_table(), *tables]).combine_chunks()

    @property
    def effects(self) -> pa.Table:
        """Why each effect of the view was needed: rows of `tables.EFFECTS`."""
        first = next(iter(self.cameras))
        return effect_table(self.subject.key, first, "any", self.rendered.effects)

    @property
    def views(self) -> pa.Table:
        """The views and their maps as PNG pictures: rows of `tables.VIEWS`."""
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


def _encode_map(plane: NDArray[np.float32]) -> bytes:
    """Shrink a conspicuity map to `MAP_PIXELS` and encode it as PNG; its maximum becomes white."""
    scale = MAP_PIXELS / max(plane.shape)
    small = cv2.resize(plane, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    peak = float(small.max())
    return _encode_png(np.rint(small * (255.0 / peak)) if peak > 0 else small)


def _encode_png(image: NDArray[np.floating]) -> bytes:
    """Encode grey (h, w) or colour (h, w, 3) values from 0 to 255 as PNG."""
    pixels = np.clip(image, 0, 255).astype(np.uint8)
    if pixels.ndim == 3:
        pixels = pixels[..., ::-1]
    _, encoded = cv2.imencode(".png", pixels)
    return bytes(encoded)
