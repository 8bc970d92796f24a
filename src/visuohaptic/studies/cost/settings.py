"""The settings whose accuracy and run time are compared, in two studies.

`frontier` is small and part of every run: few touches of one view by each of the run's strategies,
where accuracy is not yet at its limit, and what needs no other looking. `cost` has families in each
of which one thing varies over its whole range, views among them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.scene.parameters import PRESETS
from visuohaptic.studies.conditions import with_changes
from visuohaptic.studies.study import NOT_OF_RESULTS, OF_CONDITIONS, Changes, Condition, Step, Study

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
    """One way to recognise: a family, what it varies to, and its place along the family's line.

    Touches are those from each viewpoint, viewpoints those that vote, and changes other parameters
    that differ from the run's, by their dotted names.
    """

    family: str
    name: str
    place: int
    touches: int
    viewpoints: int = 1
    strategy: str = STRATEGY
    pipeline: str = PIPELINE
    classifier: ClassifierName = CLASSIFIER
    changes: Changes = field(default_factory=dict)

    @property
    def looks(self) -> int:
        """Views that must be looked at; a strategy that needs no view looks at none."""
        return self.viewpoints if STRATEGIES[self.strategy].looks else 0

    @property
    def written_changes(self) -> str:
        """The changes as JSON, sorted by name."""
        return json.dumps(dict(self.changes), sort_keys=True)

    @property
    def condition(self) -> Condition:
        """The setting as a condition of the study."""
        own = {
            "probing.strategies": (self.strategy,),
            "attention.fixations": self.touches,
            "recognition.touches": self.touches,
            "recognition.pipelines": (self.pipeline,),
            "recognition.classifiers": (self.classifier,),
            "recognition.best.classifiers": (self.classifier,),
        }
        name = f"{self.family}, {self.name}"
        return Condition(name, {**self.changes, **own}, votes=self.viewpoints)


def make_settings(run: ExperimentParameters, study: str) -> list[Setting]:
    """Give every setting of study `frontier` or `cost`, family by family; `run` has all that a family does not vary."""
    return [
        Setting(family, name, place, **{"touches": run_touches(run), **values})
        for family, vary in FAMILIES[study].items()
        for place, (name, values) in enumerate(vary(run))
    ]


def is_reference(setting: Setting, run: ExperimentParameters) -> bool:
    """Tell whether a setting is what others are compared with: the run's own, from one viewpoint."""
    own = Setting(setting.family, setting.name, setting.place, run_touches(run))
    return setting == own


def run_touches(run: ExperimentParameters) -> int:
    """Give the touches of a sequence in the run."""
    return run.recognition.touches or run.attention.fixations


Varied = Iterator[tuple[str, dict[str, Any]]]


def _touches(run: ExperimentParameters) -> Varied:
    for count in run.cost.touches:
        yield _counted(count, "touch", "es"), {"touches": count}


def _viewpoints(run: ExperimentParameters, changes: Changes | None = None) -> Varied:
    for count in run.cost.viewpoints:
        yield _counted(count, "viewpoint", "s"), {"viewpoints": count, "changes": changes or {}}


def _lean_viewpoints(run: ExperimentParameters) -> Varied:
    small = {"rendering.resolution": run.cost.lean_view_resolution}
    return _viewpoints(run, {**small, "attention.weights": _weights(run, CLASSIC_CHANNELS)})


def _squares(parameter: str, sizes: str, run: ExperimentParameters) -> Varied:
    for size in getattr(run.cost, sizes):
        yield f"{size} × {size}", _unless_own(run, parameter, size)


def _channels(run: ExperimentParameters) -> Varied:
    own = tuple(name for name, weight in run.attention.weights.model_dump().items() if weight)
    for kept in (CLASSIC_CHANNELS, own):
        yield f"{len(kept)} channels", _unless_own(run, "attention.weights", _weights(run, kept))


def _cues(run: ExperimentParameters) -> Varied:
    for name, cues in CUES.items():
        yield name, _unless_own(run, "recognition.best.cues", cues)


def _features(run: ExperimentParameters) -> Varied:
    yield from _cues(run)
    yield "skin and pose", {}


def _pipelines(run: ExperimentParameters) -> Varied:
    recognition = run.recognition
    for pipeline, names in (
        ("paper", recognition.classifiers),
        ("best", recognition.best.classifiers),
    ):
        for name in names:
            words = f"{pipeline}, {name.replace('_', ' ')}"
            yield words, {"pipeline": pipeline, "classifier": name}


def _effects(run: ExperimentParameters) -> Varied:
    for preset in PRESETS:
        yield preset, {"changes": {} if preset == run.scene.preset else {"scene.preset": preset}}


def _probed(strategy: str, run: ExperimentParameters) -> Varied:
    if strategy not in run.probing.strategies:
        return
    for viewpoints in _within(run.cost.frontier_viewpoints, run.viewpoints.total):
        for touches in _within(run.cost.frontier_touches, run_touches(run)):
            name = f"{_counted(touches, 'touch', 'es')}, {_counted(viewpoints, 'viewpoint', 's')}"
            yield name, {"touches": touches, "viewpoints": viewpoints, "strategy": strategy}


def _small_imprint(run: ExperimentParameters) -> Varied:
    """Make the imprint smaller; nothing where it is as small in the run."""
    varied = _unless_own(run, "sensor.resolution", run.cost.lean_imprint_resolution)
    if varied["changes"]:
        yield _counted(run_touches(run), "touch", "es"), varied


def _paper(run: ExperimentParameters) -> Varied:
    yield "with its map", {"pipeline": "paper"}
    without = _unless_own(run, "recognition.self_organising_map.output", "none")
    yield "without the map", {"pipeline": "paper", **without}


def _if_fixated(
    vary: Callable[[ExperimentParameters], Varied], run: ExperimentParameters
) -> Varied:
    return vary(run) if STRATEGY in run.probing.strategies else iter(())


def _within(values: Iterable[int], most: int) -> list[int]:
    return sorted({min(value, most) for value in values})


FAMILIES: dict[str, dict[str, Callable[[ExperimentParameters], Varied]]] = {
    "frontier": {
        **{name: partial(_probed, name) for name in STRATEGIES.names},
        "small_imprint": partial(_if_fixated, _small_imprint),
        "cues": partial(_if_fixated, _cues),
        "paper": partial(_if_fixated, _paper),
    },
    "cost": {
        "touches": _touches,
        "viewpoints": _viewpoints,
        "lean_viewpoints": _lean_viewpoints,
        "imprint": partial(_squares, "sensor.resolution", "imprint_resolutions"),
        "render": partial(_squares, "rendering.resolution", "view_resolutions"),
        "channels": _channels,
        "features": _features,
        "pipelines": _pipelines,
        "effects": _effects,
    },
}
"""By study and family, what varies."""


def _weights(run: ExperimentParameters, kept: Iterable[str]) -> dict[str, float]:
    weights = run.attention.weights.model_dump()
    return {name: (weights[name] or 1.0) if name in kept else 0.0 for name in weights}


def _unless_own(run: ExperimentParameters, path: str, value: object) -> dict[str, Any]:
    changes = {path: value}
    return {"changes": {} if with_changes(run, changes) == run else changes}


def _counted(count: int, noun: str, ending: str) -> str:
    return f"{count} {noun}{'' if count == 1 else ending}"


def _study(name: str, title: str, *, is_part_of_run: bool) -> Study:
    robot = {"cost": {"touch_seconds", "look_seconds"}}
    seconds = Step(
        f"{name}_seconds",
        "visuohaptic.studies.cost.seconds:make_cost_seconds",
        (f"results/{name}_seconds.parquet",),
        takes=("meshes", "features", "made"),
        needs={"exclude": {**OF_CONDITIONS["exclude"], **robot}},
        objects="timed",
        is_alone=not is_part_of_run,
        is_shown=False,
    )
    front = Step(
        name,
        "visuohaptic.studies.cost.front:make_cost",
        (f"results/{name}.parquet",),
        takes=("blocks", *seconds.files),
        needs={"exclude": NOT_OF_RESULTS.keys() - {"cost"}},
    )
    return Study(
        name,
        title,
        lambda run: (setting.condition for setting in make_settings(run, name)),
        (seconds, front),
        has_figures=not is_part_of_run,
        is_sampled=True,
        is_part_of_run=is_part_of_run,
    )


FRONTIER = _study("frontier", "Accuracy against time", is_part_of_run=True)
COST_STUDY = _study("cost", "What accuracy costs in time", is_part_of_run=False)
