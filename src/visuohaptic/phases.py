"""The phases in order, with inputs, outputs and parameters.

The functions of the phases are in `pipeline`, so that reading this list does not import the packages of the functions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from pydantic import BaseModel

from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.scene.parameters import VISUAL_EFFECTS

Sources = str | Mapping[str, str]
"""The dotted name of a parameter, or dotted names of several parameters by their names in one argument."""


@dataclass(frozen=True)
class Phase:
    """A phase of the experiment.

    Attributes
    ----------
    name : str
        Name of the phase, its rule, its folder of results and its records.
    description : str
        Participle for progress lines, such as "touching".
    arguments : mapping
        Dotted names of parameters by argument of the phase's function.
    inputs : tuple of str
        Tables that the phase reads, and ``meshes``, which are files.
    writes : mapping
        Folder below results/ by output table.
    verb : str, optional
        Verb in columns of seconds, for phases that process one object at a time.
    """

    name: str
    description: str
    arguments: Mapping[str, Sources]
    inputs: tuple[str, ...]
    writes: Mapping[str, str]
    verb: str | None = None

    @property
    def input_tables(self) -> tuple[str, ...]:
        """The inputs except the meshes."""
        return tuple(name for name in self.inputs if name != "meshes")

    def values(self, parameters: ExperimentParameters) -> dict[str, Any]:
        """Return the values of the arguments by name."""
        return {name: _value(parameters, source) for name, source in self.arguments.items()}

    def written_values(self, parameters: ExperimentParameters) -> dict[str, Any]:
        """Return the values of the arguments by name, with sections as dicts."""
        return {name: _plain(value) for name, value in self.values(parameters).items()}

    def sections(self) -> list[str]:
        """Return the dotted names of all parameters that the phase depends on."""
        names: set[str] = set()
        for source in self.arguments.values():
            names.update([source] if isinstance(source, str) else source.values())
        return sorted(names)


def _value(parameters: ExperimentParameters, source: Sources) -> Any:
    if isinstance(source, Mapping):
        return {name: attrgetter(dotted)(parameters) for name, dotted in source.items()}
    return attrgetter(source)(parameters)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    return value.model_dump() if isinstance(value, BaseModel) else value


def _fields_except(model: type[BaseModel], section: str, *omitted: str) -> dict[str, str]:
    """Return the dotted names of a section's parameters by name, except some."""
    return {name: f"{section}.{name}" for name in model.model_fields if name not in omitted}


PHASES = (
    Phase(
        "meshes",
        "preparing",
        # Without the seed: only turned objects depend on it, and their code adds it.
        arguments={"meshes": _fields_except(MeshParameters, "meshes", "set")},
        inputs=(),
        writes={"meshes": "meshes"},
    ),
    Phase(
        "fixations",
        "looking at",
        arguments={
            "viewpoints": "viewpoints",
            "rendering": "rendering",
            "attention": "attention",
            "strategies": "probing.planned",
            # Only visual effects, so that a change of the sensor's effects does not render the views again.
            "modes": {name: f"scene.effects.{name}" for name in VISUAL_EFFECTS},
            "seed": "seed",
        },
        inputs=("meshes",),
        writes={"views": "views", "fixations": "fixations", "effects": "effects/views"},
        verb="look",
    ),
    Phase(
        "touches",
        "touching",
        arguments={
            "sensor": "sensor",
            "scene": "scene",
            "seed": "seed",
            "wanted": {
                "touches": "attention.fixations",
                "unreachable": "probing.unreachable",
                "when_exhausted": "probing.when_exhausted",
            },
            "viewpoints": "viewpoints",
            "policies": "probing.policies",
        },
        inputs=("meshes", "fixations"),
        writes={
            "touches": "touches",
            "policy_fixations": "policy_fixations",
            "effects": "effects/touches",
        },
        verb="touch",
    ),
    Phase(
        "features",
        "describing the imprints of",
        arguments={"features": "features", "layout": "sensor.layout"},
        inputs=("touches",),
        writes={"features": "features"},
        verb="describe",
    ),
    Phase(
        "recognition",
        "training and testing",
        arguments={
            "recognition": _fields_except(
                RecognitionParameters, "recognition", "pipelines", "intervals"
            ),
            "seed": "seed",
        },
        inputs=("features",),
        writes={"scores": "scores", "predictions": "predictions"},
    ),
)

OF_OBJECT = tuple(phase for phase in PHASES if phase.verb)
"""Phases that process one object at a time."""


def phase(name: str) -> Phase:
    """Return a phase by its name."""
    return next(phase for phase in PHASES if phase.name == name)


def phases_after(tables: Iterable[str]) -> tuple[Phase, ...]:
    """Return the phases of `OF_OBJECT` after the last phase that writes any of `tables`."""
    existing = {*tables}
    writers = [
        number for number, phase in enumerate(OF_OBJECT, 1) if phase.writes.keys() & existing
    ]
    return OF_OBJECT[max(writers, default=0) :]


def inputs_needed_from(table: str) -> tuple[str, ...]:
    """Return the inputs, ``meshes`` or tables, from which `table` and all later tables of an object are computed."""
    first = next(index for index, phase in enumerate(OF_OBJECT) if table in phase.writes)
    remaining = OF_OBJECT[first:]
    computed = {name for phase in remaining for name in phase.writes}
    inputs = [name for phase in remaining for name in phase.inputs if name not in computed]
    return tuple(dict.fromkeys(inputs))
