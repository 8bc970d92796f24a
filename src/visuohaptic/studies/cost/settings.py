"""The settings whose accuracy and run time are compared, in two studies.

`frontier` is small and part of every run: few touches of one view by each of the run's strategies,
where accuracy is not yet at its limit, and what needs no other looking. `cost` has families in each
of which one thing varies over its whole range, views among them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.scene.parameters import PRESETS
from visuohaptic.studies.conditions import touches_of_run, with_changes
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

    def is_own(self, run: ExperimentParameters) -> bool:
        """Tell whether it is what others are compared with: the run's own, from one viewpoint."""
        return self == Setting(self.family, self.name, self.place, touches_of_run(run))

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
        Setting(family, name, place, **{"touches": touches_of_run(run), **values})
        for family, settings in FAMILIES[study](run).items()
        for place, (name, values) in enumerate(settings.items())
    ]


Families = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""By family and name, the fields in which a setting differs from the run's own."""


def frontier_families(run: ExperimentParameters) -> Families:
    """Vary touches and viewpoints of each strategy of the run, and what needs no other looking."""
    if not run.cost.frontier_touches:
        return {}
    touches = _within(run.cost.frontier_touches, touches_of_run(run))
    viewpoints = _within(run.cost.frontier_viewpoints, run.viewpoints.total)
    probed = {
        strategy: {
            f"{_count(count, 'touch', 'es')}, {_count(views, 'viewpoint')}": {
                "touches": count,
                "viewpoints": views,
                "strategy": strategy,
            }
            for views, count in product(viewpoints, touches)
        }
        for strategy in STRATEGIES.names
        if strategy in run.probing.strategies
    }
    if STRATEGY not in probed:
        return probed
    small = _unless_own(run, "sensor.resolution", run.cost.lean_imprint_resolution)
    own = _count(touches_of_run(run), "touch", "es")
    mapless = _unless_own(run, "recognition.self_organising_map.output", "none")
    return {
        **probed,
        "small_imprint": {own: small} if small["changes"] else {},
        "cues": _cues(run),
        "paper": {
            "with its map": {"pipeline": "paper"},
            "without the map": {"pipeline": "paper", **mapless},
        },
    }


def cost_families(run: ExperimentParameters) -> Families:
    """Vary one thing in each family, over its whole range."""
    cost, weights = run.cost, run.attention.weights.model_dump()
    named = {"paper": run.recognition.classifiers, "best": run.recognition.best.classifiers}
    classic, own = (
        {name: (weight or 1.0) if name in kept else 0.0 for name, weight in weights.items()}
        for kept in (CLASSIC_CHANNELS, [name for name, weight in weights.items() if weight])
    )
    lean = {"rendering.resolution": cost.lean_view_resolution, "attention.weights": classic}
    views = {_count(count, "viewpoint"): {"viewpoints": count} for count in cost.viewpoints}
    return {
        "touches": {_count(count, "touch", "es"): {"touches": count} for count in cost.touches},
        "viewpoints": views,
        "lean_viewpoints": {name: {**values, "changes": lean} for name, values in views.items()},
        "imprint": _sizes(run, "sensor.resolution", cost.imprint_resolutions),
        "render": _sizes(run, "rendering.resolution", cost.view_resolutions),
        "channels": {
            f"{sum(map(bool, kept.values()))} channels": _unless_own(run, "attention.weights", kept)
            for kept in (classic, own)
        },
        "features": {**_cues(run), "skin and pose": {}},
        "pipelines": {
            f"{pipeline}, {name.replace('_', ' ')}": {"pipeline": pipeline, "classifier": name}
            for pipeline, names in named.items()
            for name in names
        },
        "effects": {
            preset: {"changes": {} if preset == run.scene.preset else {"scene.preset": preset}}
            for preset in PRESETS
        },
    }


FAMILIES: dict[str, Callable[[ExperimentParameters], Families]] = {
    "frontier": frontier_families,
    "cost": cost_families,
}
"""By study, what varies."""

ORDER = (
    *(*STRATEGIES.names, "small_imprint", "cues", "paper"),
    *("touches", "viewpoints", "lean_viewpoints", "imprint", "render", "channels", "features"),
    *("pipelines", "effects"),
)
"""The families of both studies, as they are shown."""


def _cues(run: ExperimentParameters) -> dict[str, dict[str, Any]]:
    return {name: _unless_own(run, "recognition.best.cues", cues) for name, cues in CUES.items()}


def _sizes(run: ExperimentParameters, path: str, sizes: Iterable[int]) -> dict[str, dict[str, Any]]:
    return {f"{size} × {size}": _unless_own(run, path, size) for size in sizes}


def _unless_own(run: ExperimentParameters, path: str, value: object) -> dict[str, Any]:
    changes = {path: value}
    return {"changes": {} if with_changes(run, changes) == run else changes}


def _within(values: Iterable[int], most: int) -> list[int]:
    return sorted({min(value, most) for value in values})


def _count(number: int, name: str, plural: str = "s") -> str:
    return f"{number} {name}{plural * (number != 1)}"


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
