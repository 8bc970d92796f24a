"""Define studies: conditions to compare, and the jobs that follow their measurement.

Studies of the package are entries of `registry.STUDIES`. All other studies are files in folder ``studies/``: YAML for
studies with conditions only, or Python with a `Study` named ``STUDY``, which may have steps. A study in a folder of its
own may also have sections of the report (`report.section.study_sections`) and kept results (`keeping`).
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
"""New values by dotted name of a parameter or a whole section."""

WITHOUT_EFFECT = {
    "workflow": True,
    "meshes": {"set", "own_up_axis", "own_front_axis", "largest_megabytes"},
    "cost": True,
    "probing": {"random_draws"},
}
"""Parameters without effect on any condition, in the form of argument `exclude` of `pydantic.BaseModel.model_dump`."""

DUMP_FOR_CONDITIONS = {"exclude": {**WITHOUT_EFFECT, "recognition": {"intervals"}}}
"""Arguments of `model_dump` that select the parameters with an effect on conditions."""

FIGURES = ("results/studies/{}.parquet", "reports/studies/{}.json")
"""Files with the figures of a study's conditions; ``{}`` is the study's name."""

# Patterns of the files of a study, without the files of its steps; ``{}`` is the study's name.
_OWN = (
    *FIGURES,
    *("results/study_blocks/{}/*", "results/study_features/{}/*"),
    *(f"results/study_records/{rule}/{{}}/*" for rule in ("block_of_study", "features_of_study")),
    "results/study_records/figures_of_study/{}.json",
)


@dataclass(frozen=True)
class Condition:
    """A way to run the experiment.

    Attributes
    ----------
    name : str
        Any text.
    changes : mapping of str to Any
        Values that differ from the run's, by dotted name.
    compared_with : str, optional
        Name of the condition to compare with. The default is the study's first condition.
    votes : int, optional
        The number of viewpoints that vote on an object. The default is no vote: each sequence is classified by itself.
    """

    name: str
    changes: Changes = field(default_factory=dict)
    compared_with: str | None = None
    votes: int | None = None


@dataclass(frozen=True)
class StepInputs:
    """Arguments of the job of a step.

    Attributes
    ----------
    study : str
        The study's name.
    inputs : mapping of str to sequence of str
        Files by entry of `Step.inputs`. The files of steps are together in entry ``tables``, in the order of
        `Step.inputs` and `Step.inputs_where`. ``meshes`` has one file per object.
    outputs : sequence of str
        The files to write: `Step.files` with the values of the wildcards.
    run : ExperimentParameters
        The parameters that the step needs; all other parameters have their defaults.
    wildcards : mapping of str to str
        Values of the wildcards, for a step with one job per pipeline or condition.
    recomputed_features : mapping of str to str
        Files by key of the conditions; empty if the step reads only the run's features.
    objects : sequence of str, optional
        The objects, ``class/name``, of a study that measures a sample. The default is all objects.
    condition : mapping, optional
        The condition as `conditions.describe_conditions` returns it, for a step with one job per condition.
    processes : int
        The number of processes that the job may start. Results do not depend on this number.
    """

    study: str
    inputs: Mapping[str, Sequence[str]]
    outputs: Sequence[str]
    run: ExperimentParameters
    wildcards: Mapping[str, str] = field(default_factory=dict)
    recomputed_features: Mapping[str, str] = field(default_factory=dict)
    objects: Sequence[str] | None = None
    condition: Mapping[str, Any] | None = None
    processes: int = 1


OBJECTS_OF_STEP = ("study", "timed", "two")
"""Values of `Step.objects`."""


@dataclass(frozen=True)
class Step:
    """A job of a study in addition to the blocks of conditions.

    Attributes
    ----------
    name : str
        Name of the rule, log and record. Unique among the steps of all studies.
    work : str
        The function, as ``module:function``, which takes `StepInputs` and writes the outputs. Only the job imports
        the module. The module's code is part of the job's key.
    files : tuple of str
        The files to write. With ``{condition}`` or ``{pipeline}`` in all names, the step has one job per value.
    inputs : tuple of str
        Inputs: tables of the run (``meshes``, ``fixations``, ``features``, ``predictions``), ``blocks`` of the
        conditions, ``recomputed_features``, and files of steps of any study. If a step takes ``predictions``, the
        blocks leave out conditions that `conditions.is_measured_by_run` finds in the run. If the study measures
        only a sample of the objects, ``predictions`` is empty and the blocks are complete. A step with
        ``{condition}`` ignores `inputs`: it gets the ``features`` and ``recomputed_features`` of its condition.
    inputs_where : mapping of str to str
        Dotted name of a parameter to file of a step. The step takes the file only if the parameter is true.
    needs : mapping
        Arguments of `pydantic.BaseModel.model_dump` that select the parameters of the step.
    objects : str
        The objects whose meshes and fixations the step takes: ``study`` (all objects that the study measures),
        ``timed`` (at most `cost.objects` evenly spaced objects of the study) or ``two`` (at most two).
    is_block : bool
        Whether the files contain rows of `tables.STUDY`. If so, they are inputs of the figures and of steps that take
        ``blocks``.
    is_alone : bool
        Whether the job reserves all cores, because it measures run times or starts processes.
    is_shown : bool
        Whether the report shows the files.
    """

    name: str
    work: str
    files: tuple[str, ...]
    inputs: tuple[str, ...] = ("blocks",)
    inputs_where: Mapping[str, str] = field(default_factory=dict)
    needs: Mapping[str, Any] = field(
        default_factory=lambda: {"include": {"recognition": {"intervals"}}}
    )
    objects: str = "study"
    is_block: bool = False
    is_alone: bool = False
    is_shown: bool = True

    @property
    def wildcards(self) -> tuple[str, ...]:
        """The names of the wildcards in the first file; there is one job per combination of their values."""
        return tuple(name for name in ("condition", "pipeline") if f"{{{name}}}" in self.files[0])

    @property
    def record(self) -> str:
        """The file with the record of the job, with wildcards in braces (see `visuohaptic_workflow.records`)."""
        each = "".join(f"/{{{name}}}" for name in self.wildcards)
        return f"results/study_records/{self.name}{each}.json"


def accuracies_step(study: str) -> Step:
    """Return the step that arranges the measured accuracies of a study as a table to keep.

    Function ``<study>.accuracies:make_<study>`` takes the blocks, writes ``results/<study>.parquet``, and needs only the
    name of the set of objects.
    """
    work = f"{study}.accuracies:make_{study}"
    needs = {"include": {"meshes": {"set"}}}
    return Step(study, work, (f"results/{study}.parquet",), needs=needs)


@dataclass(frozen=True)
class Study:
    """Conditions to compare, and the steps that follow their measurement.

    Attributes
    ----------
    name : str
        Name of the study in rules and files.
    title : str
        Heading in the report.
    conditions : callable
        Takes the run's parameters and returns the conditions.
    steps : tuple of Step
        Further jobs. Snakemake orders the jobs by their files; the order here is the order of `shown`.
    has_figures : bool
        Whether the figures of the conditions, `tables.STUDY_FIGURES`, are written to `FIGURES`.
    is_sampled : bool
        Whether the study measures a sample of at most ``cost.maximum_objects`` objects.
    is_part_of_run : bool
        Whether every run contains the study. Parameter `workflow.studies` adds studies to a run.
    is_coded : bool
        Whether the study is part of the package or a Python file. Rule ``study_<name>`` makes any study and the
        report; a coded study also has rule ``<name>_all``.
    kept : str
        The Parquet or JSON file of a step that `keeping` copies into the study's folder; empty if no result is kept.
    """

    name: str
    title: str
    conditions: Callable[[ExperimentParameters], Iterable[Condition]] = lambda _: ()
    steps: tuple[Step, ...] = ()
    has_figures: bool = True
    is_sampled: bool = False
    is_part_of_run: bool = False
    is_coded: bool = True
    kept: str = ""

    @property
    def shown(self) -> tuple[str, ...]:
        """The files that the report shows, with wildcards in braces; the first file dates the study."""
        steps = (file for step in self.steps if step.is_shown for file in step.files)
        return (*self._figures, *steps)

    @property
    def targets(self) -> tuple[str, ...]:
        """The files and records of figures and steps to make for the study.

        Left out: blocks of conditions, and steps with wildcards. Files of steps with `is_block` are included.
        """
        steps = (step for step in self.steps if not step.wildcards)
        return (*self._figures, *(file for step in steps for file in (*step.files, step.record)))

    @property
    def _figures(self) -> tuple[str, ...]:
        """`FIGURES` with the study's name, or nothing without figures."""
        return tuple(file.format(self.name) for file in FIGURES if self.has_figures)

    @property
    def patterns(self) -> tuple[str, ...]:
        """Patterns for `fnmatch` of all files that the study and its steps write; no other study writes them."""
        own = (pattern.format(self.name) for pattern in _OWN)
        steps = (name for step in self.steps for name in (*step.files, step.record))
        return tuple(re.sub(r"{\w+}", "*", pattern) for pattern in (*own, *steps))

    @property
    def all_inputs(self) -> tuple[str, ...]:
        """The entries of `inputs` and files of `inputs_where` of all steps, whether or not the parameters are true."""
        return tuple(
            name for step in self.steps for name in (*step.inputs, *step.inputs_where.values())
        )

    def owns(self, file: str) -> bool:
        """Return whether a file matches one of `patterns`."""
        # Compare the fixed beginning first, which is faster than to compile each pattern.
        return any(
            file.startswith(re.split(r"[*?[]", pattern)[0]) and fnmatchcase(file, pattern)
            for pattern in self.patterns
        )


def do_step(work: str, folders: Iterable[Path], arguments: StepInputs) -> None:
    """Import and call a function of a step.

    Parameters
    ----------
    work : str
        The function, as ``module:function``.
    folders : iterable of Path
        Folders to append to `sys.path` before the import.
    arguments : StepInputs
        The only argument of the function.
    """
    sys.path += map(str, folders)
    module, _, function = work.partition(":")
    getattr(import_module(module), function)(arguments)
