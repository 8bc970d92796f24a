"""What ablations leave out or exchange, and how much of the run each makes anew."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from visuohaptic.attention.parameters import CHANNELS

PIPELINES = ("paper", "best")

Remade = Literal["nothing", "descriptors", "touches", "views"]
"""What an ablation makes anew; all before it is taken from the run."""


@dataclass(frozen=True)
class Ablation:
    """One thing that is changed.

    Attributes
    ----------
    name : str
        What is left, or what is left out.
    group : str
        What it is compared within.
    remade : str
        What is made anew.
    pipelines : tuple of str
        The pipelines that it says something about.
    """

    name: str
    group: str
    remade: Remade
    pipelines: tuple[str, ...] = PIPELINES


WHOLE = Ablation("whole_method", "whole", "nothing")

ABLATIONS = {
    ablation.name: ablation
    for ablation in (
        WHOLE,
        Ablation("cutaneous_only", "cues", "nothing"),
        Ablation("kinesthetic_only", "cues", "nothing"),
        Ablation("contourlet_only", "descriptors", "nothing"),
        Ablation("nonsubsampled_contourlet", "descriptors", "descriptors"),
        Ablation("wavelet", "descriptors", "descriptors"),
        Ablation("image_statistics", "descriptors", "nothing"),
        Ablation("fixed_sensor_size", "sensor", "touches"),
        Ablation("without_map", "map", "nothing", ("paper",)),
        Ablation("ideal", "scene", "touches"),
        Ablation("fsr400", "scene", "touches"),
        Ablation("worn_fsr", "scene", "touches"),
        *(Ablation(f"without_{channel}", "attention", "views") for channel in CHANNELS),
    )
}
"""What is measured, the whole method first. `whole_method` has both cues, the adaptive size and the map."""
