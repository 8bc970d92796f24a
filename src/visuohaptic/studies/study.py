"""What a study is: conditions to compare, and the jobs that follow their measurement.

A study of the package is an entry of `registry.STUDIES`. All others lie in folder ``studies/``: YAML for conditions
alone, or Python with a `Study` named ``STUDY``, which may have steps of its own. A study that is a folder may bring its
section of the report, too (`report.section.study_sections`).
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from importlib import import_module
from pathlib import Path
from typing import Any

from visuohaptic.parameters import ExperimentParameters

Changes = Mapping[str, Any]
"""New values by the parameters' dotted names; a whole section may be named."""

WITHOUT_EFFECT = {
    "workflow": True,
    "meshes": {"set", "own_up_axis", "largest_megabytes"},
    "cost": True,
    "probing": {"random_draws"},
}
"""Parameters that no condition depends on, as `pydantic.BaseModel.model_dump` excludes them."""

DUMP_FOR_CONDITIONS = {"exclude": {**WITHOUT_EFFECT, "recognition": {"intervals"}}}
"""All that conditions depend on."""

FIGURES = ("results/studies/{}.parquet", "reports/studies/{}.json")
"""What sums up a study's conditions, by its name."""

_OWN = (
    *FIGURES,
    *("results/study_blocks/{}/*", "results/study_features/{}/*"),
    *(f"results/study_records/{rule}/{{}}/*" for rule in ("block_of_study", "features_of_study")),
    "results/study_records/figures_of_study/{}.json",
)


@dataclass(frozen=True)
class Condition:
    """One way to run the experiment: `changes` say what differs from the run's parameters.

    Its name is any text; `compared_with` names the condition that it is compared with, None the
    study's first. So many `votes`, viewpoints, name an object together; with None each sequence
    counts by itself.
    """

    name: str
    changes: Changes = field(default_factory=dict)
    compared_with: str | None = None
    votes: int | None = None


@dataclass(frozen=True)
class StepInputs:
    """What a step's job is given: `inputs`, files by what the step takes, and `outputs`, its own files, to be written.

    `run` has the parameters that the step needs; all others have their defaults. `wildcards` are
    those of a step with a job for each pipeline or condition, and `condition` is its condition, as
    `conditions.describe_conditions` gives it. `made` has files of features that conditions share,
    by key. `objects`, ``class/name``, count; None for all. The number of `processes`
    that it may start changes no result.
    """

    study: str
    inputs: Mapping[str, Sequence[str]]
    outputs: Sequence[str]
    run: ExperimentParameters
    wildcards: Mapping[str, str] = field(default_factory=dict)
    made: Mapping[str, str] = field(default_factory=dict)
    objects: Sequence[str] | None = None
    condition: Mapping[str, Any] | None = None
    processes: int = 1


@dataclass(frozen=True)
class Step:
    """A job of a study beside the blocks of its conditions.

    Attributes
    ----------
    name : str
        What its rule, log and record are called.
    work : str
        The function that does it, as ``module:function``, imported by its job only: it takes `StepInputs` and
        writes the outputs. Its module is part of the job's key.
    files : tuple of str
        What it makes; with ``{condition}`` or ``{pipeline}`` in them there is a job for each.
    takes : tuple of str
        Tables of the run (``meshes``, ``fixations``, ``features``, ``predictions``), ``blocks`` of the conditions,
        ``made`` (features of all conditions that the run does not have), and files of other steps. Where a step takes
        predictions, blocks leave out the conditions that the run itself measured.
    takes_where : mapping of str to str
        Files of other steps that it takes only where a parameter is true, by the parameter's dotted name.
    needs : mapping
        Parameters that it depends on, as `pydantic.BaseModel.model_dump` takes them.
    objects : str
        Whose meshes and fixations it takes: ``all``, the ``study``'s, ``two``, or the ``timed`` objects.
    is_block : bool
        Whether its files hold rows of `tables.STUDY`, which count as blocks do.
    is_alone : bool
        Whether it takes all cores: it measures run times, or starts processes of its own.
    is_shown : bool
        Whether the report shows its files.
    """

    name: str
    work: str
    files: tuple[str, ...]
    takes: tuple[str, ...] = ("blocks",)
    takes_where: Mapping[str, str] = field(default_factory=dict)
    needs: Mapping[str, Any] = field(
        default_factory=lambda: {"include": {"recognition": {"intervals"}}}
    )
    objects: str = "study"
    is_block: bool = False
    is_alone: bool = False
    is_shown: bool = True

    @property
    def wildcards(self) -> tuple[str, ...]:
        """The wildcards in the names of its files; each combination of their values has a job."""
        return tuple(name for name in ("condition", "pipeline") if f"{{{name}}}" in self.files[0])

    @property
    def record(self) -> str:
        """The file that says what made its files."""
        each = "".join(f"/{{{name}}}" for name in self.wildcards)
        return f"results/study_records/{self.name}{each}.json"


@dataclass(frozen=True)
class Study:
    """Conditions under one title, and the steps that follow.

    Attributes
    ----------
    name, title : str
        What rules and files call it, and its heading in the report.
    conditions : callable
        Returns a run's conditions; the others are compared with the first.
    steps : tuple of Step
        Jobs of its own, in the order of their work.
    has_figures : bool
        Whether each condition's accuracy is summed up in `tables.STUDY_FIGURES`.
    is_sampled : bool
        Whether it measures a sample of many objects (``cost.maximum_objects``).
    is_part_of_run : bool
        Whether every run makes it.
    is_on_request : bool
        Whether later runs leave the study's files until its own target is asked for.
    is_coded : bool
        Whether it comes with the package or as Python, and so has a rule ``<name>_all``, too.
    """

    name: str
    title: str
    conditions: Callable[[ExperimentParameters], Iterable[Condition]] = lambda _: ()
    steps: tuple[Step, ...] = ()
    has_figures: bool = True
    is_sampled: bool = False
    is_part_of_run: bool = False
    is_on_request: bool = False
    is_coded: bool = True

    @property
    def shown(self) -> tuple[str, ...]:
        """The files that the report shows; the first has the study's date."""
        steps = (file for step in self.steps if step.is_shown for file in step.files)
        return (*self._figures, *steps)

    @property
    def targets(self) -> tuple[str, ...]:
        """The files that are made where the study is asked for, without its blocks."""
        steps = (step for step in self.steps if not step.wildcards)
        return (*self._figures, *(file for step in steps for file in (*step.files, step.record)))

    @property
    def _figures(self) -> tuple[str, ...]:
        return tuple(file.format(self.name) for file in FIGURES if self.has_figures)

    @property
    def patterns(self) -> tuple[str, ...]:
        """Patterns of the files that are made only for the study."""
        own = (pattern.format(self.name) for pattern in _OWN)
        steps = (name for step in self.steps for name in (*step.files, step.record))
        return tuple(re.sub(r"{\w+}", "*", pattern) for pattern in (*own, *steps))

    @property
    def taken(self) -> tuple[str, ...]:
        """What its steps take: tables of the run, and files of steps, those of other studies too."""
        return tuple(
            name for step in self.steps for name in (*step.takes, *step.takes_where.values())
        )

    def owns(self, file: str) -> bool:
        """Return whether a file is made only for the study."""
        # Most patterns differ in their folder, for which no pattern has to be compiled.
        return any(
            file.startswith(re.split(r"[*?[]", pattern)[0]) and fnmatchcase(file, pattern)
            for pattern in self.patterns
        )


def do_step(work: str, folders: Iterable[Path], step: StepInputs) -> None:
    """Do a step's work; modules are also looked for in some folders, after all others."""
    sys.path += map(str, folders)
    module, _, function = work.partition(":")
    getattr(import_module(module), function)(step)
