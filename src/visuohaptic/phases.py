"""The phases in order: inputs, outputs and parameters of each. `pipeline` has the functions.

Rules, keys, studies, `exploration` and `visuohaptic tables` read this list, without the packages that the functions need.
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
"""The dotted name of a parameter, or of several that make one argument, by their names there."""


@dataclass(frozen=True)
class Phase:
    """One step of the experiment.

    Attributes
    ----------
    name : str
        The name of the phase, its rule, its folder of results and its records.
    description : str
        A participle for progress lines: "touching".
    arguments : mapping
        Dotted names of parameters by argument of the phase's function.
    inputs : tuple of str
        Tables of the run that the phase reads. ``meshes`` are files.
    writes : mapping
        Folder below results/ by output table.
    verb : str, optional
        Set for phases that take one object at a time: the verb in progress lines and in columns of seconds.
    """

    name: str
    description: str
    arguments: Mapping[str, Sources]
    inputs: tuple[str, ...]
    writes: Mapping[str, str]
    verb: str | None = None

    @property
    def input_tables(self) -> tuple[str, ...]:
        """Inputs without the meshes."""
        return tuple(name for name in self.inputs if name != "meshes")

    def values(self, parameters: ExperimentParameters) -> dict[str, Any]:
        """Return the values of the arguments."""
        return {name: _value(parameters, source) for name, source in self.arguments.items()}

    def written_values(self, parameters: ExperimentParameters) -> dict[str, Any]:
        """Return the values of the arguments in built-in types."""
        return {name: _plain(value) for name, value in self.values(parameters).items()}

    def sections(self) -> list[str]:
        """Return the dotted names of all parameters that the phase depends on."""
        sources = self.arguments.values()
        names = (source.values() if isinstance(source, Mapping) else [source] for source in sources)
        return sorted({name for some in names for name in some})


def _value(parameters: ExperimentParameters, source: Sources) -> Any:
    if isinstance(source, Mapping):
        return {name: attrgetter(dotted)(parameters) for name, dotted in source.items()}
    return attrgetter(source)(parameters)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    return value.model_dump() if isinstance(value, BaseModel) else value


def _all_but(model: type[BaseModel], section: str, *left_out: str) -> dict[str, str]:
    return {name: f"{section}.{name}" for name in model.model_fields if name not in left_out}


PHASES = (
    Phase(
        "meshes",
        "preparing",
        # The seed, which turns objects, is added where they are turned: another seed makes no other upright meshes.
        arguments={"meshes": _all_but(MeshParameters, "meshes", "set")},
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
            # Only effects of the view, so that an effect of the sensor renders no view again.
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
        arguments={"features": "features"},
        inputs=("touches",),
        writes={"features": "features"},
        verb="describe",
    ),
    Phase(
        "recognition",
        "training and testing",
        arguments={
            "recognition": _all_but(RecognitionParameters, "recognition", "pipelines", "intervals"),
            "seed": "seed",
        },
        inputs=("features",),
        writes={"scores": "scores", "predictions": "predictions"},
    ),
)

OF_OBJECT = tuple(phase for phase in PHASES if phase.verb)
"""Phases that take one object at a time."""


def phase(name: str) -> Phase:
    """Return a phase by its name."""
    return next(phase for phase in PHASES if phase.name == name)


def phases_after(tables: Iterable[str]) -> tuple[Phase, ...]:
    """Return the phases of one object that follow the last writer of any of the named tables."""
    known = {*tables}
    writers = [n for n, phase in enumerate(OF_OBJECT, 1) if phase.writes.keys() & known]
    return OF_OBJECT[max(writers, default=0) :]


def inputs_needed_from(table: str) -> tuple[str, ...]:
    """Return the inputs, ``meshes`` or tables, that are needed to make `table` and all later tables of an object."""
    first = next(n for n, phase in enumerate(OF_OBJECT) if table in phase.writes)
    remaining = OF_OBJECT[first:]
    made = {name for phase in remaining for name in phase.writes}
    return tuple(
        dict.fromkeys(name for phase in remaining for name in phase.inputs if name not in made)
    )
