"""The settings that are weighed: families in each of which one thing varies."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.scene.parameters import PRESETS
from visuohaptic.studies.conditions import Changes, Condition, Study, with_changes

STRATEGY = "fixation"
PIPELINE = "best"
CLASSIFIER: ClassifierName = "support_vector_machine"
"""What names the objects where the family is about something else."""

CLASSIC_CHANNELS = ("colour", "intensity", "orientation")
"""The channels of Itti, Koch and Niebur (1998)."""

CUES = {
    "skin alone": ("contourlet", "imprint", "sensor"),
    "pose alone": ("pose", "relations", "embedding"),
}


@dataclass(frozen=True)
class Setting:
    """One way to recognise.

    Attributes
    ----------
    family, name : str
        What varies, and to which value.
    place : int
        Its place along the family's line.
    touches : int
        Touches from each viewpoint.
    viewpoints : int
        Viewpoints that vote.
    pipeline, classifier : str
        What names the object.
    changes : mapping of str
        Other parameters that differ from the run's, by their dotted names.
    """

    family: str
    name: str
    place: int
    touches: int
    viewpoints: int = 1
    pipeline: str = PIPELINE
    classifier: ClassifierName = CLASSIFIER
    changes: Changes = field(default_factory=dict)

    @property
    def written_changes(self) -> str:
        """The changes as JSON, sorted by name."""
        return json.dumps(dict(self.changes), sort_keys=True)

    @property
    def condition(self) -> Condition:
        """The setting as a condition of the study."""
        own = {
            "probing.strategies": (STRATEGY,),
            "attention.fixations": self.touches,
            "recognition.touches": self.touches,
            "recognition.pipelines": (self.pipeline,),
            "recognition.classifiers": (self.classifier,),
            "recognition.best.classifiers": (self.classifier,),
        }
        name = f"{self.family}, {self.name}"
        return Condition(name, {**self.changes, **own}, votes=self.viewpoints)


def cost_study(run: ExperimentParameters) -> Study:
    """Give the settings of all families as conditions."""
    conditions = tuple(setting.condition for setting in make_settings(run))
    return Study("cost", "What accuracy costs in time", conditions)


def make_settings(run: ExperimentParameters) -> list[Setting]:
    """Give every setting, family by family; what a family does not vary is as in the run."""
    return [setting for family in FAMILIES for setting in family_settings(family, run)]


def family_settings(family: str, run: ExperimentParameters) -> list[Setting]:
    """Give the settings of one of `FAMILIES`."""
    touches = run.recognition.touches or run.attention.fixations
    return [
        Setting(family, name, place, **{"touches": touches, **values})
        for place, (name, values) in enumerate(FAMILIES[family](run))
    ]


Varied = Iterator[tuple[str, dict[str, Any]]]


def _touches(run: ExperimentParameters) -> Varied:
    for count in run.cost.touches:
        yield _counted(count, "touch", "es"), {"touches": count}


def _viewpoints(run: ExperimentParameters, changes: Changes | None = None) -> Varied:
    for count in run.cost.viewpoints:
        yield _counted(count, "viewpoint", "s"), {"viewpoints": count, "changes": changes or {}}


def _lean_viewpoints(run: ExperimentParameters) -> Varied:
    return _viewpoints(
        run,
        {
            "rendering.resolution": run.cost.lean_view_resolution,
            "attention.weights": _weights(run, CLASSIC_CHANNELS),
        },
    )


def _imprint(run: ExperimentParameters) -> Varied:
    return _squares(run, "sensor.resolution", run.cost.imprint_resolutions)


def _render(run: ExperimentParameters) -> Varied:
    return _squares(run, "rendering.resolution", run.cost.view_resolutions)


def _squares(run: ExperimentParameters, parameter: str, sizes: Sequence[int]) -> Varied:
    for size in sizes:
        yield f"{size} × {size}", _unless_own(run, parameter, size)


def _channels(run: ExperimentParameters) -> Varied:
    for kept in (CLASSIC_CHANNELS, tuple(run.attention.weights.model_dump())):
        weights = _weights(run, kept)
        yield f"{len(kept)} channels", _unless_own(run, "attention.weights", weights)


def _features(run: ExperimentParameters) -> Varied:
    for name, cues in {**CUES, "skin and pose": run.recognition.best.cues}.items():
        yield name, _unless_own(run, "recognition.best.cues", cues)


def _pipelines(run: ExperimentParameters) -> Varied:
    for pipeline, names in (
        ("paper", run.recognition.classifiers),
        ("best", run.recognition.best.classifiers),
    ):
        for name in names:
            words = f"{pipeline}, {name.replace('_', ' ')}"
            yield words, {"pipeline": pipeline, "classifier": name}


def _effects(run: ExperimentParameters) -> Varied:
    for preset in PRESETS:
        changes = {} if preset == run.scene.preset else {"scene.preset": preset}
        yield preset, {"changes": changes}


FAMILIES: dict[str, Callable[[ExperimentParameters], Varied]] = {
    "touches": _touches,
    "viewpoints": _viewpoints,
    "lean_viewpoints": _lean_viewpoints,
    "imprint": _imprint,
    "render": _render,
    "channels": _channels,
    "features": _features,
    "pipelines": _pipelines,
    "effects": _effects,
}


def _weights(run: ExperimentParameters, kept: Iterable[str]) -> dict[str, float]:
    weights = run.attention.weights.model_dump()
    return {name: (weights[name] or 1.0) if name in kept else 0.0 for name in weights}


def _unless_own(run: ExperimentParameters, path: str, value: object) -> dict[str, Any]:
    changes = {path: value}
    return {"changes": {} if with_changes(run, changes) == run else changes}


def _counted(count: int, noun: str, ending: str) -> str:
    return f"{count} {noun}{'' if count == 1 else ending}"
