"""Find files of former jobs beside the files of today's jobs, and move them aside.

Readers such as ``pandas.read_parquet("results/touches")`` read all files of a folder. After a change of the objects,
the viewpoints or the size of blocks, files of former blocks would add rows of other parameters, or repeat rows.
"""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from glob import iglob
from pathlib import Path

from visuohaptic.base.atomic_files import storage_fault
from visuohaptic_workflow.keys import Job, read_record

RECORDS = [Path("results", kind) for kind in ("records", "study_records", "model_records")]
"""Folders with the records of jobs: of the run, of studies, and of models."""

ASIDE = Path(".cache/aside")
"""The folder for files of former jobs; each move makes a subfolder with the time in its name."""

_WILDCARD = re.compile(r"{(\w+)}")
_PART = "[^/]"
_ONE_PART = f"{_PART}+"


def find_former_files(
    jobs: Mapping[str, Job],
    covered: Collection[str],
    patterns: Iterable[str],
    constraints: Mapping[str, str],
) -> list[str]:
    """Find the files that no job of today makes, in the folders of tables that some jobs write to.

    A file belongs to a former job if its name fits a pattern, or if it is a table of a record that belongs to no job of
    today. Other files are the user's own.

    Parameters
    ----------
    jobs : mapping of str to Job
        All jobs of today by record.
    covered : collection of str
        Records of the jobs that a run covers. Only folders of tables that these jobs write to are searched, such as
        ``results/touches`` or ``results/study_blocks/frontier``.
    patterns : iterable of str
        Patterns of the outputs of the covered jobs' rules, with wildcards such as ``{objects}``.
    constraints : mapping of str to str
        Regular expressions of wildcards; other wildcards are one part of a path.

    Returns
    -------
    list of str
        Sorted paths of files and folders relative to the working directory, those under ``results`` first.
    """
    today = {file for job in jobs.values() for file in job.outputs}
    folders = {table_folder(file) for record in covered for file in jobs[record].tables}
    former = {file for pattern in patterns for file in _fitting(pattern, constraints)} - today
    for record in _existing_records() - today:
        content = read_record(record)
        if {table_folder(table) for table in content.get("tables", {})} & folders:
            former |= {record, *content["tables"], content["log"]}
    if former:  # a job of today may share its log with a former job
        today |= {read_record(record).get("log", "") for record in jobs}
    existing = (file for file in former - today if os.path.lexists(file))
    return sorted(existing, key=lambda file: (not file.startswith("results/"), file))


def table_folder(file: str) -> str:
    """Return the folder that users read as one table: ``results/<table>``, or ``results/study_<kind>/<study>``."""
    parts = Path(file).parts
    return "/".join(parts[: 3 if parts[1:] and parts[1].startswith("study") else 2])


def move_aside(files: Collection[str]) -> str:
    """Move files and folders to a new subfolder of `ASIDE`, and remove folders that are empty then.

    Returns
    -------
    str
        The subfolder.
    """
    target = ASIDE / time.strftime("%Y-%m-%d-%H%M%S")
    for file in map(Path, files):
        if not os.path.lexists(file):  # it lay in a folder that was moved
            continue
        _move(file, target / file)
        with suppress(OSError):  # `rmdir` fails at the first folder that is not empty
            for folder in file.parents[:-2]:
                folder.rmdir()
    return str(target)


def _move(source: Path, target: Path) -> None:
    """Move a file or folder, also to another file system. Raises `StorageError` if a disk is full or read-only."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        # `Path.rename` can't move between file systems.
        shutil.move(source, target)
    except OSError as error:
        if fault := storage_fault(error, error.filename or target):
            raise fault from error
        raise


def _existing_records() -> set[str]:
    return {
        os.path.join(place, name)  # noqa: PTH118 - thousands of files, and a Path takes longer
        for folder in RECORDS
        for place, _, names in os.walk(folder)
        for name in names
        if name.endswith(".json")
    }


def _fitting(pattern: str, constraints: Mapping[str, str]) -> Iterator[str]:
    """Yield the existing files that fit a pattern of a rule; none for a pattern without wildcards."""
    names = _WILDCARD.findall(pattern)
    if not names:
        return
    of_wildcard = {name: constraints.get(name, _ONE_PART) for name in names}
    literal, *rest = _WILDCARD.split(pattern)
    expression = re.escape(literal)
    for name, text in zip(rest[::2], rest[1::2], strict=True):
        expression += f"(?:{of_wildcard[name]}){re.escape(text)}"
    # The name of a block of objects has two parts.
    globs = {name: "*/*" if "/" in of_wildcard[name].replace(_PART, "") else "*" for name in names}
    for file in iglob(_WILDCARD.sub(lambda match: globs[match[1]], pattern)):  # noqa: PTH207 - Path.glob takes longer
        if re.fullmatch(expression, file):
            yield file
