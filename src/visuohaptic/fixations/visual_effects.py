"""The visual effects: the decision whether each is needed, and the colours without colour or texture."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.texture import Texture
from visuohaptic.base.arrays import FloatArray
from visuohaptic.scene.parameters import VISUAL_EFFECTS, Mode, VisualModes
from visuohaptic.scene.records import EffectRecord


@dataclass
class VisualPlan:
    """Whether a visual effect is needed and simulated, the reason, and its processor seconds."""

    effect: str
    mode: Mode
    needed: bool
    simulated: bool
    reason: str
    seconds: float = 0.0

    @contextmanager
    def clock(self) -> Iterator[None]:
        """Add the processor time of the block to the effect's seconds."""
        started = time.process_time()
        yield
        self.seconds += time.process_time() - started

    def record(self, views: int) -> EffectRecord:
        """Return the effect's record, with views in place of touches."""
        runs = views * self.simulated
        needed = views * self.needed
        return EffectRecord(self.effect, self.mode, self.reason, views, needed, runs, self.seconds)


def plan_visual(
    modes: VisualModes, colours: NDArray[np.uint8], ambient: float
) -> dict[str, VisualPlan]:
    """Decide which of `VISUAL_EFFECTS` are needed.

    Parameters
    ----------
    modes : VisualModes
        The mode of each effect.
    colours : ndarray of shape (n, 3), uint8
        All colours of the object's faces and images.
    ambient : float
        Share of ambient light.

    Returns
    -------
    dict of str to VisualPlan
        The decision per effect.
    """
    coloured = bool((colours != colours[:, :1]).any())
    patterned = bool((colours != colours[:1]).any())
    directed = ambient < 1
    shaded = directed and modes.shading != "never"
    light = "part of the light has a direction" if directed else "all light is ambient"
    needs = {
        "colour": (coloured, "faces or images have hues" if coloured else "all faces are grey"),
        "texture": (
            patterned,
            "faces or images differ in colour" if patterned else "all faces have one colour",
        ),
        "shading": (directed, light),
        "cast_shadows": (
            shaded,
            light if shaded or not directed else "without shading no light is blocked",
        ),
    }
    plans = {}
    for effect in VISUAL_EFFECTS:
        mode, (needed, reason) = getattr(modes, effect), needs[effect]
        simulated = mode == "always" or (mode == "auto" and needed)
        plans[effect] = VisualPlan(effect, mode, needed, simulated, reason)
    return plans


def seen_colours(
    face_colours: NDArray[np.uint8], face_areas: FloatArray, modes: VisualModes
) -> NDArray[np.uint8]:
    """Return the faces' colours (f, 3), uint8, without effects of mode ``never``.

    Without texture all faces have the mean colour by area; without colour each has the grey of its luma (ITU-R
    BT.601).
    """
    if "never" not in (modes.texture, modes.colour):
        return face_colours
    colours = face_colours.astype(np.float64)
    if modes.texture == "never":
        mean = (colours * face_areas[:, None]).sum(axis=0) / face_areas.sum()
        colours = np.repeat(mean[None], len(colours), axis=0)
    if modes.colour == "never":
        colours = _greys(colours)
    return np.round(colours).astype(np.uint8)


def seen_texture(texture: Texture, modes: VisualModes) -> Texture:
    """Return the texture; if colour is never simulated, with the grey of each texel's luma."""
    if modes.colour != "never":
        return texture
    images = tuple(
        np.round(_greys(image.astype(np.float64))).astype(np.uint8) for image in texture.images
    )
    return replace(texture, images=images)


def _greys(colours: FloatArray) -> FloatArray:
    luma = np.einsum("...c,c->...", colours, np.array([0.299, 0.587, 0.114]))
    return np.repeat(luma[..., None], 3, axis=-1)
