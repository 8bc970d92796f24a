"""Settings whose accuracy and run time are compared, and study `frontier`, which is part of every run.

Study `frontier` varies the numbers of touches and viewpoints of each strategy. Its other settings use the same views:
small imprints, fewer cues, and pipeline `paper`.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from itertools import product
from operator import getitem
from typing import Any

from visuohaptic.active.registry import STRATEGIES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS, touches_of_run
from visuohaptic.studies.study import (
    WITHOUT_EFFECT,
    Changes,
    Condition,
    Step,
    Study,
)

ORDER = (*STRATEGIES.names, "small_imprint", "cues", "paper")
"""The families of study `frontier`, in the order of the report."""


@dataclass(frozen=True)
class Setting:
    """A way to recognise objects.

    Attributes
    ----------
    family, name : str
        The family varies a parameter; the name says the parameter's value.
    place : int
        Rank of the setting in its family.
    touches, viewpoints : int
        The number of touches per viewpoint, and the number of viewpoints that vote.
    strategy, pipeline, classifier : str
        Names of the probing strategy, the pipeline and the classifier.
    changes : mapping of str to Any
        Other parameters that differ from the run's, by dotted name.
    """

    family: str
    name: str
    place: int
    touches: int
    viewpoints: int = 1
    strategy: str = "fixation"
    pipeline: str = "order_free"
    classifier: ClassifierName = HEADLINE_CLASSIFIERS["order_free"]
    changes: Changes = field(default_factory=dict)

    @property
    def written_changes(self) -> str:
        """The changes as JSON, sorted by name."""
        return json.dumps(dict(self.changes), sort_keys=True)

    def is_reference(self, run: ExperimentParameters) -> bool:
        """Return whether all settings are compared with this setting: the run's parameters, one viewpoint."""
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
            "recognition.order_free.classifiers": (self.classifier,),
        }
        name = f"{self.family}, {self.name}"
        return Condition(name, {**self.changes, **own}, votes=self.viewpoints)


Families = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""Changes by family and name of a setting. Keys are fields of `Setting`, or dotted names of parameters."""

CUES: Mapping[str, Mapping[str, Any]] = {
    "skin alone": {"recognition.order_free.cues": ("contourlet", "imprint", "sensor")},
    "pose alone": {"recognition.order_free.cues": ("pose", "relations", "embedding")},
}


def make_settings(run: ExperimentParameters, families: Families) -> list[Setting]:
    """Make the settings of families; values that a family does not vary are the run's."""
    own, settings = run.model_dump(), list[Setting]()
    for family, names in families.items():
        for place, (name, values) in enumerate(names.items()):
            fields: Any = {key: value for key, value in values.items() if "." not in key}
            changes = {
                path: values[path]
                for path in values
                if "." in path and values[path] != reduce(getitem, path.split("."), own)
            }
            fields = {"touches": touches_of_run(run), "changes": changes, **fields}
            settings.append(Setting(family, name, place, **fields))
    return settings


def frontier_families(run: ExperimentParameters) -> Families:
    """Return the families of study `frontier`."""
    cost, most = run.cost, touches_of_run(run)
    touches = sorted({min(count, most) for count in cost.frontier_touches})
    viewpoints = sorted({min(count, run.viewpoints.total) for count in cost.frontier_viewpoints})
    probed = {
        strategy: {
            f"{counted(count, 'touch', 'es')}, {counted(views, 'viewpoint')}": {
                "touches": count,
                "viewpoints": views,
                "strategy": strategy,
            }
            for views, count in product(viewpoints, touches)
        }
        for strategy in STRATEGIES.names
        if strategy in run.probing.strategies
    }
    if not touches or "fixation" not in probed:
        return probed
    small = {counted(most, "touch", "es"): {"sensor.resolution": cost.lean_imprint_resolution}}
    paper = {"pipeline": "paper", "classifier": HEADLINE_CLASSIFIERS["paper"]}
    mapless = {"recognition.self_organising_map.output": "none"}
    return {
        **probed,
        "small_imprint": {} if run.sensor.resolution == cost.lean_imprint_resolution else small,
        "cues": CUES,
        "paper": {"with its map": paper, "without the map": {**paper, **mapless}},
    }


def counted(number: int, name: str, plural: str = "s") -> str:
    """Write a number and a noun, such as ``3 touches``."""
    return f"{number} {name}{plural * (number != 1)}"


def frontier_settings(run: ExperimentParameters) -> list[Setting]:
    """Make the settings of study `frontier`."""
    return make_settings(run, frontier_families(run))


def cost_study(
    name: str,
    title: str,
    settings: Callable[[ExperimentParameters], Sequence[Setting]],
    works: tuple[str, str],
    *,
    is_part_of_run: bool = False,
) -> Study:
    """Make a study that compares run time and error rate of settings.

    `works` names, as ``module:function``, the function that measures the seconds and the function that writes
    `tables.COST`.
    """
    # The timed models are fitted on all objects.
    unread = {
        "cost": {"touch_seconds", "look_seconds"},
        "recognition": {"intervals", "protocol"},
    }
    seconds = Step(
        f"{name}_seconds",
        works[0],
        (f"results/{name}_seconds.parquet",),
        inputs=("meshes", "features", "recomputed_features"),
        needs={"exclude": {**WITHOUT_EFFECT, **unread}},
        objects="timed",
        is_alone=not is_part_of_run,
        is_shown=False,
    )
    front = Step(
        name,
        works[1],
        (f"results/{name}.parquet",),
        inputs=("blocks", "predictions", *seconds.files),
        needs={"exclude": {**WITHOUT_EFFECT, "cost": set()}},
    )
    return Study(
        name,
        title,
        lambda run: (setting.condition for setting in settings(run)),
        (seconds, front),
        has_figures=not is_part_of_run,
        is_sampled=True,
        is_part_of_run=is_part_of_run,
    )


FRONTIER = cost_study(
    "frontier",
    "Accuracy against time",
    frontier_settings,
    (
        "visuohaptic.studies.cost.seconds:make_frontier_seconds",
        "visuohaptic.studies.cost.front:make_frontier",
    ),
    is_part_of_run=True,
)
