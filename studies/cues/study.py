"""Study `cues`: the accuracy by positions only, normals only, both, imprints only, and all."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal, NamedTuple

from visuohaptic.geometry.turning import Turns
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.studies.conditions import ONE_CLASSIFIER
from visuohaptic.studies.study import Changes, Condition, Study, accuracies_step

Tested = Literal["new", "known"]
"""Test objects: new objects of known classes, or objects that were also trained on, seen from new viewpoints."""

CueName = Literal["position", "normal", "pose", "imprint", "all"]

CUES: Mapping[CueName, str] = {
    "position": "positions only",
    "normal": "normals only",
    "pose": "positions and normals, no imprint",
    "imprint": "imprints only",
    "all": "all",
}
"""The cues of a touch, in words."""

STRATEGIES = ("fixation", "random", "random_visible")

TOUCHES = (1, 2, 5)
"""Numbers of touches per sequence."""

KNOWN_OF_TOUCH: dict[CueName, Changes] = {
    "position": {
        "recognition.cues": ("position",),
        "recognition.order_free.cues": ("position",),
    },
    "normal": {
        "recognition.cues": ("normal",),
        "recognition.order_free.cues": ("normal",),
    },
    "pose": {
        "recognition.cues": ("kinesthetic",),
        "recognition.order_free.cues": ("pose", "relations", "embedding"),
    },
    "imprint": {
        "recognition.cues": ("cutaneous",),
        "recognition.order_free.cues": ("contourlet", "imprint", "sensor"),
    },
    "all": {},
}
"""Parameters by cue of a touch."""


class Way(NamedTuple):
    """Test objects, their turns, the known part of their pose, and the pipelines to measure."""

    tested: Tested
    turns: Turns
    frame: Frame
    pipelines: tuple[str, ...]


WAYS = (
    Way("new", "none", "full", ("paper", "order_free")),
    Way("new", "none", "none", ("order_free",)),
    Way("new", "vertical", "vertical", ("order_free",)),
    Way("new", "any", "none", ("order_free",)),
    Way("known", "none", "full", ("paper", "order_free")),
    Way("known", "none", "none", ("order_free",)),
)
"""The measured ways. Pipeline `paper` has no frame: its input is the whole pose."""

PROTOCOLS: dict[Tested, str] = {"new": "auto", "known": "new_viewpoint"}


def name_of(way: Way, cues: CueName, touches: int) -> str:
    """Return the name of a condition from its parts, without the pipelines."""
    return f"{way.tested} {way.turns} {way.frame} {cues} {touches}"


def is_bare(frame: Frame, touches: int) -> bool:
    """Return whether positions and normals tell nothing: those of a single touch, if nothing is known of the pose."""
    return frame == "none" and touches == 1


def conditions(_run: ExperimentParameters) -> Iterator[Condition]:
    """Yield one condition per way, cue and number of touches.

    If nothing is known of the object's pose, a single touch has neither position nor normal: there is no condition.
    """
    for way in WAYS:
        for cues, changed in KNOWN_OF_TOUCH.items():
            for touches in TOUCHES:
                if is_bare(way.frame, touches) and cues not in ("imprint", "all"):
                    continue
                changes = {
                    **ONE_CLASSIFIER,
                    **changed,
                    "meshes.turns": way.turns,
                    "probing.strategies": STRATEGIES,
                    "recognition.pipelines": way.pipelines,
                    "recognition.frame": way.frame,
                    "recognition.touches": touches,
                    "recognition.protocol.protocol": PROTOCOLS[way.tested],
                }
                yield Condition(name_of(way, cues, touches), changes)


STUDY = Study(
    "cues",
    "What carries the accuracy",
    conditions,
    steps=(accuracies_step("cues"),),
    has_figures=False,
    kept="results/cues.parquet",
)
