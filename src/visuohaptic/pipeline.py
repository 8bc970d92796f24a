"""The phases in their order: what each takes and gives, by which parameters, and what does its work.

Rules, keys, stages of DVC, studies, `exploration` and `visuohaptic tables` read this list. A phase that takes
one object at a time is here, in its folder and in no other place.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import pyarrow as pa
from pydantic import BaseModel

from visuohaptic.features.describing import describe
from visuohaptic.fixations.sight import Sight
from visuohaptic.geometry.subject import Subject
from visuohaptic.meshes.files import make_meshes
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.one_phase import Tables, Work, check_arguments
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.files import make_scores
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.scene.parameters import VISUAL_EFFECTS
from visuohaptic.touches.touching import acquire_touches

Sources = str | Mapping[str, str]
"""The dotted name of a parameter, or of several that make one argument, by their names there."""

VIEWPOINTS_AT_ONCE = 8
"""Viewpoints that are worked on together; it changes no result."""


@dataclass(frozen=True)
class Phase:
    """One step of the experiment; `name` is also that of its rule, of its stage of DVC and of its records.

    `work` does it: for a phase with a `verb`, which takes one object at a time, it takes a `Subject`, one
    table for each that is read, and the `arguments`, which are parameters, and gives an object with a table
    for each that is written. `reads` are tables of the run; ``meshes`` are files. `writes` are folders below
    results/, by table.
    """

    name: str
    doing: str
    work: Work
    arguments: Mapping[str, Sources]
    reads: tuple[str, ...]
    writes: Mapping[str, str]
    verb: str | None = None

    @property
    def takes(self) -> tuple[str, ...]:
        """Tables that it reads, without meshes."""
        return tuple(name for name in self.reads if name != "meshes")

    def values(self, parameters: ExperimentParameters) -> dict[str, Any]:
        """Give the values of its arguments."""
        return {name: _value(parameters, found) for name, found in self.arguments.items()}

    def written_values(self, parameters: ExperimentParameters) -> dict[str, Any]:
        """Give the values of its arguments in built-in types."""
        return {name: _plain(value) for name, value in self.values(parameters).items()}

    def sections(self) -> list[str]:
        """Name the parameters that it depends on."""
        found = self.arguments.values()
        names = (one.values() if isinstance(one, Mapping) else [one] for one in found)
        return sorted({name for some in names for name in some})

    def run(self, subject: Subject, tables: Tables, parameters: ExperimentParameters) -> Any:
        """Take one object through it; gives an object with a table for each that is written."""
        arguments = check_arguments(self.work, self.values(parameters))
        return self.work(subject, *(tables[name] for name in self.takes), **arguments)


def _value(parameters: ExperimentParameters, found: Sources) -> Any:
    if isinstance(found, Mapping):
        return {name: attrgetter(one)(parameters) for name, one in found.items()}
    return attrgetter(found)(parameters)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    return value.model_dump() if isinstance(value, BaseModel) else value


def _all_but(model: type[BaseModel], section: str, *left_out: str) -> dict[str, str]:
    return {name: f"{section}.{name}" for name in model.model_fields if name not in left_out}


PHASES = (
    Phase(
        "meshes",
        "preparing",
        make_meshes,
        arguments={"meshes": _all_but(MeshParameters, "meshes", "set")},
        reads=(),
        writes={"meshes": "meshes"},
    ),
    Phase(
        "fixations",
        "looking at",
        Sight,
        arguments={
            "viewpoints": "viewpoints",
            "rendering": "rendering",
            "attention": "attention",
            "strategies": "probing.strategies",
            # Those of the view alone, so that an effect of the sensor renders no view again.
            "modes": {name: f"scene.effects.{name}" for name in VISUAL_EFFECTS},
            "seed": "seed",
        },
        reads=("meshes",),
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
        },
        reads=("meshes", "fixations"),
        writes={"touches": "touches", "effects": "effects/touches"},
        verb="touch",
    ),
    Phase(
        "features",
        "describing the imprints of",
        describe,
        arguments={"features": "features"},
        reads=("touches",),
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
        reads=("features",),
        writes={"scores": "scores", "predictions": "predictions"},
    ),
)

OF_OBJECT = tuple(phase for phase in PHASES if phase.verb)
"""Those that take one object at a time."""


def phase(name: str) -> Phase:
    """Give a phase by its name."""
    return next(one for one in PHASES if one.name == name)


def run(subject: Subject, parameters: ExperimentParameters, tables: Tables | None = None) -> Tables:
    """Take one object through the phases: look, touch, describe, the same as the workflow does.

    `tables` are what is known: it goes on behind the last of these. Gives these, and of each later phase
    what the next ones read, and ``features``.
    """
    if tables:
        return _go_on(subject, parameters, tables)
    parts = [_go_on(one, parameters, {}) for one in subject.blocks(VIEWPOINTS_AT_ONCE)]
    return {name: pa.concat_tables(part[name] for part in parts) for name in parts[0]}


def everywhere(parameters: ExperimentParameters, fixations: pa.Table) -> ExperimentParameters:
    """Change parameters so that all of some probing locations are touched, in reach or not."""
    attention = parameters.attention.model_copy(update={"fixations": fixations.num_rows})
    probing = parameters.probing.model_copy(
        update={"unreachable": "keep", "when_exhausted": "stop"}
    )
    return parameters.model_copy(update={"attention": attention, "probing": probing})


def _go_on(subject: Subject, parameters: ExperimentParameters, tables: Tables) -> Tables:
    found = dict(tables)
    for step in after(tables):
        found |= passed_on(step, step.run(subject, found, parameters))
    return found


def passed_on(phase: Phase, done: Any) -> Tables:
    """Give of what a phase gave the tables that another one reads."""
    return {name: getattr(done, name) for name in phase.writes if name in _READ}


def after(tables: Mapping[str, pa.Table]) -> tuple[Phase, ...]:
    """List the phases of one object behind the last that writes one of some tables."""
    known = [place for place, one in enumerate(OF_OBJECT, 1) if one.writes.keys() & tables.keys()]
    return OF_OBJECT[max(known, default=0) :]


def needed_from(table: str) -> tuple[str, ...]:
    """Name what is taken, ``meshes`` or tables, to make a table of one object again and all behind it."""
    first = next(place for place, one in enumerate(OF_OBJECT) if table in one.writes)
    behind = OF_OBJECT[first:]
    made = {name for one in behind for name in one.writes}
    return tuple(dict.fromkeys(name for one in behind for name in one.reads if name not in made))


_READ = {name for phase in PHASES for name in phase.reads}
