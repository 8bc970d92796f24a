"""Blocks of objects: one job takes several objects from the mesh to the features.

Its steps are the jobs that would otherwise run one by one: the same scripts with the same parameters, files, logs and
records. So an object's files do not depend on the block that it is in. Snakemake itself sees of a block only lists,
one a table, which name the files with their SHA-256: with thousands of objects its time goes with the number of files.
"""

from __future__ import annotations

import json
import os
import runpy
import time
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from visuohaptic.errors import VisuohapticError
from visuohaptic.interrupts import STOPPED
from visuohaptic_workflow.records import digest, is_current

if TYPE_CHECKING:
    from visuohaptic_workflow.plan import PlannedJob

LISTS = "results/blocks"
"""Folder of the lists: ``<block>/<table>.json``."""


class BlockError(VisuohapticError):
    """Some objects of a block failed."""


class _Files(list[str]):
    """Files of a job, some of them by name, as Snakemake gives them to a script."""

    def __init__(self, entries: Iterable[tuple[str, str | list[str]]]) -> None:
        super().__init__()
        for name, files in entries:
            self.extend([files] if isinstance(files, str) else files)
            if name:
                setattr(self, name, files)


class _Params(dict[str, Any]):
    """Parameters of a job, as items and as attributes."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(name) from error


@dataclass(frozen=True)
class _Step:
    """One job of a block: what its script knows as `snakemake`, and what its record is judged by."""

    rule: str
    script: str
    wildcards: SimpleNamespace
    input: _Files
    output: _Files
    params: _Params
    log: list[str]
    started: float | None = None

    @property
    def code(self) -> list[str]:
        """Files of the code."""
        return list(self.input.code)  # type: ignore[attr-defined]

    @property
    def inputs(self) -> list[str]:
        """Files that the step reads, without the code."""
        return [file for file in self.input if file not in self.code]

    @property
    def outputs(self) -> list[str]:
        """Files that the step writes; its record is one of them."""
        return list(self.output)

    @property
    def record(self) -> str:
        """The file that says what made the outputs."""
        return str(self.output.record)  # type: ignore[attr-defined]

    @property
    def tables(self) -> dict[str, str]:
        """The files that the step writes, without the record, by table."""
        below = f"/{self.wildcards.object}"
        return {
            file.partition(below)[0].removeprefix("results/"): file
            for file in self.output
            if file != self.record
        }


def divide(objects: Sequence[str], per_job: int | None) -> dict[str, list[str]]:
    """Divide objects into blocks.

    Parameters
    ----------
    objects : sequence of str
        All of them.
    per_job : int or None
        Objects of a block; without it there are no blocks.

    Returns
    -------
    dict of list of str
        By a name such as 0000-0031.
    """
    if per_job is None:
        return {}
    starts = range(0, len(objects), per_job)
    return {
        f"{start:04d}-{min(start + per_job, len(objects)) - 1:04d}": list(
            objects[start : start + per_job]
        )
        for start in starts
    }


def describe_rules(rules: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Describe what all jobs of each rule have in common, in built-in types.

    Parameters
    ----------
    rules : mapping of str to object
        Rules by name, as Snakemake's `rules` gives them.

    Returns
    -------
    dict of dict
        By rule: its code, the first of which is the script, its log, and patterns of its files and parameters, but
        for those that a function gives.
    """
    return {
        name: {
            "code": list(map(str, rule.input.code)),
            "log": str(rule.log[0]),
            "input": [
                item for item in _entries(rule.input) if item[0] != "code" and not callable(item[1])
            ],
            "output": _entries(rule.output),
            "params": {key: value for key, value in rule.params.items() if not callable(value)},
        }
        for name, rule in rules.items()
    }


def describe_jobs(jobs: Iterable[PlannedJob]) -> list[dict[str, Any]]:
    """Describe what each job has for itself: wildcards, and what functions give for them.

    Parameters
    ----------
    jobs : iterable of PlannedJob
        Jobs of one block, an object's after each other in the order in which data flows.

    Returns
    -------
    list of dict
        In the same order.
    """
    return [_describe_job(job) for job in jobs]


def _describe_job(job: PlannedJob) -> dict[str, Any]:
    asked = SimpleNamespace(**job.wildcards)
    return {
        "rule": job.name,
        "wildcards": dict(job.wildcards),
        "input": [
            (name, _plain(value(asked)))
            for name, value in job.rule.input.items()
            if callable(value)
        ],
        "params": {
            name: value(asked) for name, value in job.rule.params.items() if callable(value)
        },
    }


def _entries(files: Any) -> list[tuple[str, Any]]:
    """Give files with their names; those without come first, as they do in a rule."""
    named = [(name, item if callable(item) else _plain(item)) for name, item in files.items()]
    taken = {file for _, item in named if not callable(item) for file in _flat(item)}
    unnamed = [("", str(file)) for file in files if not callable(file) and file not in taken]
    return [*unnamed, *named]


def _plain(item: Any) -> str | list[str]:
    return str(item) if isinstance(item, str) else list(map(str, item))


def _flat(item: str | list[str]) -> list[str]:
    return [item] if isinstance(item, str) else item


def run_block(
    rules: Mapping[str, Mapping[str, Any]], jobs: Iterable[Mapping[str, Any]], lists: Iterable[str]
) -> None:
    """Run the jobs of a block one after the other, and list what they wrote.

    A job whose files are what it would make now, by their record, does not run again. A job that fails ends its
    object; the others go on.

    Parameters
    ----------
    rules : mapping of str to mapping
        As `describe_rules` gives them.
    jobs : iterable of mapping
        As `describe_jobs` gives them.
    lists : iterable of str
        The lists to write, ``<folder>/<block>/<table>.json``.

    Raises
    ------
    BlockError
        If an object failed; no list is written then.
    """
    made: dict[str, dict[str, str]] = {}
    failed = []
    is_first = True
    count = 0
    for name, group in groupby(jobs, key=lambda job: job["wildcards"]["object"]):
        count += 1
        for job in group:
            step = _make_step(rules[job["rule"]], job, None if is_first else time.time())
            if not is_current(step):
                is_first = False
                if not _succeeds(step):
                    failed.append(name)
                    break
            for table, file in step.tables.items():
                made.setdefault(table, {})[file] = digest(file)
    if failed:
        raise BlockError(
            f"{len(failed)} of {count} objects failed: {', '.join(failed)}; the others are done."
        )
    for path in lists:
        table = "/".join(Path(path).with_suffix("").parts[len(Path(LISTS).parts) + 1 :])
        _write(path, made.get(table, {}))


def _make_step(rule: Mapping[str, Any], job: Mapping[str, Any], started: float | None) -> _Step:
    wildcards = job["wildcards"]

    def fill(item: str | list[str]) -> str | list[str]:
        if isinstance(item, str):
            return item.format(**wildcards)
        return [file.format(**wildcards) for file in item]

    patterns = [(name, fill(item)) for name, item in rule["input"]]
    own = [(name, item) for name, item in job["input"]]
    return _Step(
        rule=job["rule"],
        script=rule["code"][0],
        wildcards=SimpleNamespace(**wildcards),
        input=_Files([*patterns, *own, ("code", rule["code"])]),
        output=_Files((name, fill(item)) for name, item in rule["output"]),
        params=_Params({**rule["params"], **job["params"]}),
        log=[rule["log"].format(**wildcards)],
        started=started,
    )


def _succeeds(step: _Step) -> bool:
    """Run a step as Snakemake would; its script has said why, where it fails."""
    for file in (*step.outputs, *step.log):
        Path(file).parent.mkdir(parents=True, exist_ok=True)
    for file in step.outputs:
        Path(file).unlink(missing_ok=True)
    try:
        runpy.run_path(step.script, init_globals={"snakemake": step})
    except SystemExit as end:
        if end.code == STOPPED:
            raise
        return not end.code
    return True


def _write(path: str, content: Mapping[str, str]) -> None:
    unfinished = Path(f"{path}.part")
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    unfinished.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    unfinished.replace(path)


def files_of(inputs: Iterable[str], sample: Collection[str] | None = None) -> list[str]:
    """Give the files that a job reads, those of a block from its list.

    Parameters
    ----------
    inputs : iterable of str
        Files and lists.
    sample : collection of str, optional
        Which files of lists are taken; all without it. Files that are no lists are the sample already, and a storage
        gives them other names.

    Returns
    -------
    list of str
        Files alone.
    """
    found: list[str] = []
    chosen = None if sample is None else frozenset(sample)
    for file in inputs:
        if Path(file).parts[: len(Path(LISTS).parts)] == Path(LISTS).parts:
            listed = json.loads(Path(file).read_text(encoding="utf-8"))
            found += [name for name in listed if chosen is None or name in chosen]
        else:
            found.append(file)
    return found


def is_untouched(record: str, files: Iterable[str]) -> bool:
    """Whether all files of a block are there, and none has changed since the block's record was written.

    Parameters
    ----------
    record : str
        The block's record, which is written last.
    files : iterable of str
        What its steps write.

    Returns
    -------
    bool
        By the time of a file's or link's last change, which no program sets.
    """
    with suppress(FileNotFoundError):
        last = os.lstat(record).st_ctime_ns
        return all(os.lstat(file).st_ctime_ns <= last for file in files)
    return False
