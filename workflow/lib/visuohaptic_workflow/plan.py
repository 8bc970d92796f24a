"""Which jobs the rules ask for today, and what each of them takes and gives.

Snakemake itself plans jobs only after the Snakefile is read, and keeps to itself what it finds.
The rules' own attributes, which any Snakefile may read, say enough: file patterns, input functions
and parameters.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from visuohaptic_workflow.records import TIMESTAMP

_LETTERS_WITH_N = re.compile(r"-[DFSafklpt]*n")
_NO_JOBS = frozenset(
    [
        *("--dry-run", "--dryrun", "--lint", "--help", "-h", "--version", "-v"),
        *(
            "--list",
            "--list-rules",
            "-l",
            "--list-target-rules",
            "--lt",
            "--list-untracked",
            "--lu",
        ),
        *("--summary", "-S", "--detailed-summary", "-D", "--list-changes", "--lc"),
        *("--dag", "--rulegraph", "--filegraph", "--d3dag", "--report", "--archive"),
        *("--unlock", "--cleanup-metadata", "--cm", "--cleanup-shadow", "--delete-all-output"),
        *("--delete-temp-output", "--generate-unit-tests", "--containerize", "--export-cwl"),
        *("--conda-create-envs-only", "--conda-list-envs", "--conda-cleanup-envs"),
    ]
)
_WILDCARD = re.compile(r"{(\w+)}")


@dataclass(frozen=True)
class PlannedJob:
    """One job of a rule.

    Attributes
    ----------
    name : str
        The rule's name.
    rule : object
        The rule as Snakemake's `rules` gives it.
    wildcards : dict of str
        The value of each wildcard.
    """

    name: str
    rule: Any
    wildcards: Mapping[str, str]

    @property
    def outputs(self) -> list[str]:
        """Files that the job writes; its record is one of them."""
        return [_fill(file, self.wildcards) for file in self.rule.output]

    @property
    def record(self) -> str:
        """The file that says what made the outputs."""
        return _fill(self.rule.output.record, self.wildcards)

    @property
    def logs(self) -> list[str]:
        """Log files of the job."""
        return [_fill(file, self.wildcards) for file in self.rule.log]

    @property
    def inputs(self) -> list[str]:
        """Files that the job reads, without the code."""
        code = set(self.code)
        return [file for file in self._expand(self.rule.input) if file not in code]

    @property
    def code(self) -> list[str]:
        """Files of the code that the job runs."""
        return list(map(str, getattr(self.rule.input, "code", ())))

    @property
    def params(self) -> dict[str, Any]:
        """The job's parameters by name."""
        asked = SimpleNamespace(**self.wildcards)
        return {
            name: value(asked) if callable(value) else value
            for name, value in self.rule.params.items()
        }

    def _expand(self, items: Iterable[Any]) -> Iterator[str]:
        for item in items:
            found = item(SimpleNamespace(**self.wildcards)) if callable(item) else item
            files = [found] if isinstance(found, str) else found
            yield from (_fill(str(file), self.wildcards) for file in files)


def plan_jobs(
    rules: Mapping[str, Any],
    values: Mapping[str, Sequence[str]],
    exceptions: Mapping[str, Mapping[str, Sequence[str]] | Sequence[Mapping[str, str]]],
) -> list[PlannedJob]:
    """List the jobs of all rules that keep a record.

    Parameters
    ----------
    rules : mapping of str to object
        Rules by name, in the order in which data flows.
    values : mapping of str to sequence of str
        What each wildcard stands for.
    exceptions : mapping of str to mapping, or to sequence of mapping
        The same for single rules, by name; or the wildcards of each of a rule's jobs.

    Returns
    -------
    list of PlannedJob
        In the order of the rules.
    """
    jobs = []
    for name, rule in rules.items():
        if not hasattr(rule.output, "record"):
            continue
        chosen = exceptions.get(name, {})
        if not isinstance(chosen, Mapping):
            jobs += [PlannedJob(name, rule, wildcards) for wildcards in chosen]
            continue
        wildcards = list(dict.fromkeys(_WILDCARD.findall(rule.output.record)))
        choices = {**values, **chosen}
        jobs += [
            PlannedJob(name, rule, dict(zip(wildcards, found, strict=True)))
            for found in product(*(choices[wildcard] for wildcard in wildcards))
        ]
    return jobs


def runs_jobs(arguments: Sequence[str]) -> bool:
    """Whether a command line of Snakemake runs jobs, rather than only lists or checks them.

    Snakemake itself says so only once the Snakefile is read.

    Parameters
    ----------
    arguments : sequence of str
        The command line.

    Returns
    -------
    bool
        False for a dry run, and for what only prints or changes Snakemake's own notes.
    """
    return not any(
        _LETTERS_WITH_N.match(argument) or argument.partition("=")[0] in _NO_JOBS
        for argument in arguments[1:]
    )


def prune_files(jobs: Iterable[PlannedJob], folders: Iterable[str]) -> list[Path]:
    """Delete what jobs of earlier runs have left and no job of today writes.

    Files are left over when an object goes away, or viewpoints are split into
    jobs in another way; a reader of a folder would meet their rows twice.

    Parameters
    ----------
    jobs : iterable of PlannedJob
        All jobs of today.
    folders : iterable of str
        Where to look. Only files of the kinds that jobs write there go, such as Parquet files in
        `results/touches`; a user's notes stay.

    Returns
    -------
    list of pathlib.Path
        What was deleted.
    """
    wanted = {Path(file) for job in jobs for file in (*job.outputs, *job.logs)}
    suffixes: dict[Path, set[str]] = {}
    for file in wanted:
        if len(file.parts) > 2 and file.parts[0] in set(folders):
            # A folder of meshes is an output as a whole.
            suffixes.setdefault(Path(*file.parts[:2]), {".ply"}).add(file.suffix)
    stale = []
    for folder, written in sorted(suffixes.items()):
        for file in sorted(folder.rglob("*"), reverse=True):
            if file.is_dir() and not file.is_symlink():
                if not any(file.iterdir()):
                    file.rmdir()
            elif wanted.isdisjoint([file, *file.parents]) and (
                file.suffix.partition("-")[0] in written or file.name == TIMESTAMP
            ):
                file.unlink()
                stale.append(file)
    return stale


def _fill(pattern: str, wildcards: Mapping[str, str]) -> str:
    return _WILDCARD.sub(lambda match: wildcards[match[1]], str(pattern))
