"""The settings that are weighed: families in each of which one thing varies."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.recognition.parameters import Cue
from visuohaptic.scene.parameters import PRESETS

STRATEGY = "fixation"
PIPELINE = "best"
CLASSIFIER: ClassifierName = "support_vector_machine"
"""What names the objects where the family is about something else."""

CLASSIC_CHANNELS = ("colour", "intensity", "orientation")
"""The channels of Itti, Koch and Niebur (1998)."""

CUES: dict[str, tuple[Cue, ...]] = {
    "skin alone": ("contourlet", "imprint", "sensor"),
    "pose alone": ("pose", "relations", "embedding"),
}

Changes = tuple[tuple[str, Any], ...]


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
    changes : tuple of (str, value)
        Other parameters that differ from the run's, by their dotted names.
    """

    family: str
    name: str
    place: int
    touches: int
    viewpoints: int
    pipeline: str
    classifier: ClassifierName
    changes: Changes = ()

    @property
    def before_recognition(self) -> Changes:
        """The changes that have a say in the touches."""
        return tuple(change for change in self.changes if not change[0].startswith("recognition"))

    @property
    def written_changes(self) -> str:
        """The changes as JSON, sorted by name."""
        return json.dumps(dict(self.changes), sort_keys=True)

    def parameters(self, run: ExperimentParameters) -> ExperimentParameters:
        """Give all parameters of the setting.

        Parameters
        ----------
        run : ExperimentParameters
            The run's.

        Returns
        -------
        ExperimentParameters
            Those with the setting's changes, its touches and its one classifier.
        """
        own: Changes = (
            ("attention.fixations", self.touches),
            ("recognition.touches", self.touches),
            ("recognition.classifiers", (self.classifier,)),
            ("recognition.best.classifiers", (self.classifier,)),
        )
        return with_changes(run, (*self.changes, *own))


def condition_of(setting: Setting) -> Changes:
    """Give what tells one setting's features from another's, fit to be a key."""
    return hashable(setting.before_recognition)


def hashable(changes: Changes) -> Changes:
    """Give changes with their values written out, fit to be a key."""
    return tuple((path, repr(value)) for path, value in changes)


def with_changes(run: ExperimentParameters, changes: Changes) -> ExperimentParameters:
    """Change parameters by their dotted names; a whole section may be named.

    Parameters
    ----------
    run : ExperimentParameters
        What is changed.
    changes : tuple of (str, value)
        New values.

    Returns
    -------
    ExperimentParameters
        Checked.

    Raises
    ------
    ParameterError
        If a value is not allowed.
    """
    values = run.model_dump()
    for path, value in changes:
        *sections, name = path.split(".")
        section = values
        for part in sections:
            section = section[part]
        section[name] = value
    return ExperimentParameters.from_mapping(values)


def make_settings(run: ExperimentParameters) -> list[Setting]:
    """Give every setting of every family.

    Parameters
    ----------
    run : ExperimentParameters
        The run's; its own values are those of all that a family does not vary.

    Returns
    -------
    list of Setting
        Family by family.
    """
    return [setting for make in FAMILIES.values() for setting in make(run)]


def family_settings(family: str, run: ExperimentParameters) -> list[Setting]:
    """Give the settings of one of `FAMILIES`."""
    return FAMILIES[family](run)


def _make(
    family: str,
    run: ExperimentParameters,
    varied: Iterable[tuple[str, dict[str, Any]]],
) -> list[Setting]:
    touches = run.recognition.touches or run.attention.fixations
    usual = {"touches": touches, "viewpoints": 1, "pipeline": PIPELINE, "classifier": CLASSIFIER}
    return [
        Setting(family=family, name=name, place=place, **{**usual, **values})
        for place, (name, values) in enumerate(varied)
    ]


def _touches(run: ExperimentParameters) -> list[Setting]:
    counts = run.cost.touches
    return _make(
        "touches", run, ((_counted(count, "touch", "es"), {"touches": count}) for count in counts)
    )


def _viewpoints(run: ExperimentParameters) -> list[Setting]:
    return _make("viewpoints", run, _votes(run, ()))


def _lean_viewpoints(run: ExperimentParameters) -> list[Setting]:
    lean = (
        ("rendering.resolution", run.cost.lean_view_resolution),
        ("attention.weights", _weights(run, CLASSIC_CHANNELS)),
    )
    return _make("lean_viewpoints", run, _votes(run, lean))


def _imprint(run: ExperimentParameters) -> list[Setting]:
    return _squares("imprint", run, "sensor.resolution", run.cost.imprint_resolutions)


def _render(run: ExperimentParameters) -> list[Setting]:
    return _squares("render", run, "rendering.resolution", run.cost.view_resolutions)


def _squares(
    family: str, run: ExperimentParameters, parameter: str, sizes: Sequence[int]
) -> list[Setting]:
    named = ((f"{size} × {size}", _unless_own(run, parameter, size)) for size in sizes)
    return _make(family, run, ((name, {"changes": changes}) for name, changes in named))


def _channels(run: ExperimentParameters) -> list[Setting]:
    every = tuple(run.attention.weights.model_dump())
    return _make(
        "channels",
        run,
        (
            (
                f"{len(kept)} channels",
                {"changes": _unless_own(run, "attention.weights", _weights(run, kept))},
            )
            for kept in (CLASSIC_CHANNELS, every)
        ),
    )


def _features(run: ExperimentParameters) -> list[Setting]:
    cues = {**CUES, "skin and pose": run.recognition.best.cues}
    return _make(
        "features",
        run,
        (
            (name, {"changes": _unless_own(run, "recognition.best.cues", chosen)})
            for name, chosen in cues.items()
        ),
    )


def _pipelines(run: ExperimentParameters) -> list[Setting]:
    classifiers = {
        "paper": run.recognition.classifiers,
        "best": run.recognition.best.classifiers,
    }
    return _make(
        "pipelines",
        run,
        (
            (
                f"{pipeline}, {name.replace('_', ' ')}",
                {"pipeline": pipeline, "classifier": name},
            )
            for pipeline, names in classifiers.items()
            for name in names
        ),
    )


def _effects(run: ExperimentParameters) -> list[Setting]:
    return _make(
        "effects",
        run,
        (
            (preset, {"changes": () if preset == run.scene.preset else (_scene(preset),)})
            for preset in PRESETS
        ),
    )


FAMILIES: dict[str, Callable[[ExperimentParameters], list[Setting]]] = {
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


def _votes(run: ExperimentParameters, changes: Changes) -> Iterable[tuple[str, dict[str, Any]]]:
    for count in run.cost.viewpoints:
        yield _counted(count, "viewpoint", "s"), {"viewpoints": count, "changes": changes}


def _scene(preset: str) -> tuple[str, dict[str, str]]:
    return ("scene", {"preset": preset})


def _weights(run: ExperimentParameters, kept: Iterable[str]) -> dict[str, float]:
    weights = run.attention.weights.model_dump()
    return {name: (weights[name] or 1.0) if name in kept else 0.0 for name in weights}


def _unless_own(run: ExperimentParameters, path: str, value: object) -> Changes:
    changed = with_changes(run, ((path, value),))
    return () if changed == run else ((path, value),)


def _counted(count: int, noun: str, ending: str) -> str:
    return f"{count} {noun}{'' if count == 1 else ending}"
