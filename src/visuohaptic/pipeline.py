"""The phases in order: inputs, outputs, parameters and the function of each.

Rules, keys, studies, `exploration` and `visuohaptic tables` read this list. A new phase that takes one object at a
time needs an entry here and a folder.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import pyarrow as pa
from pydantic import BaseModel

from visuohaptic.features.describing import describe
from visuohaptic.fixations.object_views import ObjectViews
from visuohaptic.geometry.subject import Subject
from visuohaptic.io.phase_files import Tables, Work, check_arguments
from visuohaptic.meshes.files import make_meshes
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.files import make_scores
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.scene.parameters import VISUAL_EFFECTS
from visuohaptic.touches.acquiring import acquire_touches

Sources = str | Mapping[str, str]
"""The dotted name of a parameter, or of several that make one argument, by their names there."""

VIEWPOINTS_AT_ONCE = 8
"""Viewpoints that are worked on together; it changes no result."""


@dataclass(frozen=True)
class Phase:
    """One step of the experiment.

    Attributes
    ----------
    name : str
        The name of the phase, its rule, its folder of results and its records.
    description : str
        A participle for progress lines: "touching".
    work : callable
        With a `verb`: ``work(subject, *input_tables, **arguments)`` returns an object with one attribute per
        output table. Without a `verb`, the function reads and writes files instead.
    arguments : mapping
        Dotted names of parameters by argument of `work`.
    inputs : tuple of str
        Tables of the run that the phase reads. ``meshes`` are files.
    writes : mapping
        Folder below results/ by output table.
    verb : str, optional
        Set for phases that take one object at a time: the verb in progress lines and in columns of seconds.
    """

    name: str
    description: str
    work: Work
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

    def run(self, subject: Subject, tables: Tables, parameters: ExperimentParameters) -> Any:
        """Run the phase for one object and return an object with one attribute per output table."""
        arguments = check_arguments(self.work, self.values(parameters))
        return self.work(subject, *(tables[name] for name in self.input_tables), **arguments)


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
        make_meshes,
        # The seed, which turns objects, is added where they are turned: another seed makes no other upright meshes.
        arguments={"meshes": _all_but(MeshParameters, "meshes", "set")},
        inputs=(),
        writes={"meshes": "meshes"},
    ),
    Phase(
        "fixations",
        "looking at",
        ObjectViews,
        arguments={
            "viewpoints": "viewpoints",
            "rendering": "rendering",
            "attention": "attention",
            "strategies": "probing.planned",
            # Those of the view alone, so that an effect of the sensor renders no view again.
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
        acquire_touches,
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
        describe,
        arguments={"features": "features"},
        inputs=("touches",),
        writes={"features": "features"},
        verb="describe",
    ),
    Phase(
        "recognition",
        "training and testing",
        make_scores,
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


def run(subject: Subject, parameters: ExperimentParameters, tables: Tables | None = None) -> Tables:
    """Run all phases of one object in memory; the results equal those of the workflow.

    `tables`: results that exist already, by name. Only the phases after the last of them run. Returns these tables,
    ``features``, and every table of the phases that ran which a later phase reads.
    """
    if tables:
        return _run_remaining(subject, parameters, tables)
    parts = [_run_remaining(block, parameters, {}) for block in subject.blocks(VIEWPOINTS_AT_ONCE)]
    return {name: pa.concat_tables(part[name] for part in parts) for name in parts[0]}


def touch_all_locations(
    parameters: ExperimentParameters, fixations: pa.Table
) -> ExperimentParameters:
    """Return parameters with which every probing location of a table is touched, in reach or not."""
    attention = parameters.attention.model_copy(update={"fixations": fixations.num_rows})
    probing = parameters.probing.model_copy(
        update={"unreachable": "keep", "when_exhausted": "stop"}
    )
    return parameters.model_copy(update={"attention": attention, "probing": probing})


def _run_remaining(subject: Subject, parameters: ExperimentParameters, tables: Tables) -> Tables:
    results = dict(tables)
    for step in phases_after(tables):
        results |= tables_for_next(step, step.run(subject, results, parameters))
    return results


def tables_for_next(phase: Phase, outputs: Any) -> Tables:
    """Return the output tables of a phase that another phase reads."""
    return {name: getattr(outputs, name) for name in phase.writes if name in _READ}


def phases_after(tables: Mapping[str, pa.Table]) -> tuple[Phase, ...]:
    """Return the phases of one object that follow the last writer of any of `tables`."""
    writers = [n for n, phase in enumerate(OF_OBJECT, 1) if phase.writes.keys() & tables.keys()]
    return OF_OBJECT[max(writers, default=0) :]


def inputs_needed_from(table: str) -> tuple[str, ...]:
    """Return the inputs, ``meshes`` or tables, that are needed to make `table` and all later tables of an object."""
    first = next(n for n, phase in enumerate(OF_OBJECT) if table in phase.writes)
    remaining = OF_OBJECT[first:]
    made = {name for phase in remaining for name in phase.writes}
    return tuple(
        dict.fromkeys(name for phase in remaining for name in phase.inputs if name not in made)
    )


_READ = {name for phase in PHASES for name in phase.inputs}
