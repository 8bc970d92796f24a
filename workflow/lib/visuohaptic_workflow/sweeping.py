"""Sweep the folder of a run before Snakemake plans: each table that is there is current, and stale tables are not there.

Stale files move to a store by key, and files that the store holds for today's keys move back. So Snakemake only asks
whether a file exists, and a return to former values runs no job.
"""

from __future__ import annotations

import atexit
import os
import re
import shutil
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from glob import iglob
from operator import itemgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from visuohaptic.base.errors import StorageError
from visuohaptic_workflow.clocks import date_at_present
from visuohaptic_workflow.keys import Keys, read_record

RECORDS = ("results/records/", "results/study_records/")
"""Folders with the records of jobs of the run and of studies."""

MODEL_RECORDS = ("results/model_records/",)
"""The folder with the records of models, which stay as they are until a command asks for a model."""

STORE = Path(".cache/tables")
"""The folder of the store. The files of a job are in ``<record>/<key>``, each under its path in the working folder."""

ASIDE = Path(".cache/aside")
"""The folder for files that fit no record; each move makes a subfolder with the time in its name."""

_FOLDERS = ("results/", "reports/", "logs/", "meshes/downloaded/")
"""Folders of files that jobs write. No other file is moved."""

_SUFFIXES = {".parquet", ".json", ".csv", ".html", ".gz", ".skops", ".log"}
_BLOCK_OF_MESHES = re.compile("results/meshes/[^/]+/[^/]+")
"""The folders that jobs write."""

_FAR = 4e9  # s, in the year 2096
_KEY = re.compile("[0-9a-f]{64}")
_WILDCARD = re.compile(r"{(\w+)}")
_PART = "[^/]"
_ONE_PART = f"{_PART}+"


@dataclass(frozen=True)
class Sweep:
    """What a sweep does, and the jobs that are not current after the sweep.

    Attributes
    ----------
    stored : dict of Path to tuple of str
        Files that move to the store, by folder of the store. The record is the last file.
    aside : tuple of str
        Files that move to `ASIDE`: edited or cut tables, tables without a record, and their records.
    returned : dict of Path to tuple of str
        Files that come back from the store, by folder of the store. The record is the last file.
    stale : dict of str to str
        Reason to run a job (`Keys.reason_not_current`) by record, for all jobs that are not current after the sweep.
    """

    stored: dict[Path, tuple[str, ...]]
    aside: tuple[str, ...]
    returned: dict[Path, tuple[str, ...]]
    stale: dict[str, str]

    @property
    def moved(self) -> list[str]:
        """The files that move out of the folders of tables."""
        return [*(file for files in self.stored.values() for file in files), *self.aside]


def plan_sweep(
    keys: Keys, folders: tuple[str, ...], patterns: Iterable[str], constraints: Mapping[str, str]
) -> Sweep:
    """Compare the files of jobs with today's keys. Nothing is moved.

    A file belongs to a job if a record lists the file, if a job of today writes the file, or if its name fits a pattern.
    Other files are the user's own and stay.

    Parameters
    ----------
    keys : Keys
        The keys of all jobs of today.
    folders : tuple of str
        Folders with the records of the jobs, `RECORDS` or `MODEL_RECORDS`.
    patterns : iterable of str
        Patterns of the outputs of the jobs' rules, with wildcards such as ``{objects}``.
    constraints : mapping of str to str
        Regular expressions of wildcards; other wildcards are one part of a path.

    Returns
    -------
    Sweep
        The moves, and the jobs that are not current after the moves.
    """
    jobs = [record for record in keys.jobs if record.startswith(folders)]
    reasons = {
        record: reason for record in jobs if (reason := keys.reason_not_current(record)) is not None
    }
    current = keys.jobs.keys() - reasons.keys()
    stays = {file for record in current for file in keys.jobs[record].outputs}
    records = sorted(_existing_records(folders) - stays)
    if records:  # a former job may share its log with a current job
        stays |= {read_record(record).get("log", "") for record in current}
    stored: dict[Path, tuple[str, ...]] = {}
    moved: set[str] = set()
    unfit: set[str] = set()
    for record in records:
        content = read_record(record)
        files = _files_of(record, content) if content else [record]
        fits = (
            content
            and _KEY.fullmatch(str(content["key"]))
            and all(map(_is_of_a_job, content["tables"]))
            and keys.has_tables_of(content)
        )
        if fits and stays.isdisjoint(content["tables"]):
            stored[folder_of(record, content["key"])] = tuple(
                file for file in files if os.path.lexists(file) and file not in stays
            )
            moved.update(files)
        else:
            unfit.update(files)
    unfit |= {file for record in reasons for file in keys.jobs[record].outputs}
    unfit |= {file for pattern in patterns for file in _fitting(pattern, constraints)}
    returned = {
        folder_of(record, keys.key(record)): tuple(_files_of(record, content))
        for record in reasons
        if (content := _read_stored(keys, record))
    }
    back = {files[-1] for files in returned.values()}
    return Sweep(
        stored=stored,
        aside=tuple(sorted(file for file in unfit - moved - stays if os.path.lexists(file))),
        returned=returned,
        stale={record: reason for record, reason in reasons.items() if record not in back},
    )


def is_at_hand(keys: Keys, record: str) -> bool:
    """Return whether a job's files are current, or the store has files of its present key."""
    return keys.reason_not_current(record) is None or bool(_read_stored(keys, record))


def carry_out(sweep: Sweep, most_bytes: float) -> list[str]:
    """Move the files of a sweep, and remove the oldest folders of the store beyond a size.

    A kill leaves no job with the record of a current job but without its tables: then the next run runs the job.

    Parameters
    ----------
    sweep : Sweep
        The moves.
    most_bytes : float
        The largest size (bytes) of the store.

    Returns
    -------
    list of str
        Files from the store that had a time in the future, and now have the present time.

    Raises
    ------
    StorageError
        If a file can't be moved, for example because a disk is full. All files are at their old or new place.
    """
    if sweep.aside:
        target = ASIDE / time.strftime("%Y-%m-%d-%H%M%S")
        _move_all((Path(file), target / file) for file in sweep.aside)
    for folder, files in sweep.stored.items():
        _move_all((Path(file), folder / file) for file in files)
        # A rename leaves the time of the folder as it was.
        with suppress(OSError):
            os.utime(folder)
    for folder, files in sweep.returned.items():
        _move_all((folder / file, Path(file)) for file in files)
        shutil.rmtree(folder, ignore_errors=True)
        # `make` writes DVC's lock again if the report is newer. A file of another user keeps its time.
        for file in files:
            with suppress(OSError):
                os.utime(file)
    if sweep.stored:
        prune(most_bytes)
    return date_at_present(file for files in sweep.returned.values() for file in files)


@cache
def stale_marker() -> str:
    """Return a folder, newer than any result, that makes Snakemake list a job whose outputs exist.

    The folder is among the temporary files of the system and is removed when the process ends.
    """
    folder = TemporaryDirectory(prefix="visuohaptic-")
    atexit.register(folder.cleanup)
    os.utime(folder.name, (_FAR, _FAR))
    return folder.name


def prune(most_bytes: float) -> None:
    """Remove the folders of the store that were filled first, until the rest has at most `most_bytes`.

    Nothing that a run, a lock of DVC or an experiment needs is only in the store: its files can be made again.
    """
    folders = sorted(_folders_in_store(), key=itemgetter(0), reverse=True)
    total = 0
    for _, size, folder in folders:
        total += size
        if total > most_bytes:
            shutil.rmtree(folder, ignore_errors=True)


def folder_of(record: str, key: str) -> Path:
    """Return the folder of the store for the files that a job, named by its record, made with a key."""
    return _folders_of(record) / str(key)


def find_former(record: str) -> dict[str, Any]:
    """Return the record (`keys.read_record`) of a job that the store got last; empty without one."""
    with suppress(OSError):
        folders = sorted(_folders_of(record).iterdir(), key=lambda path: path.stat().st_mtime)
        if folders:
            return read_record(folders[-1] / record)
    return {}


def is_stored(pattern: str) -> bool:
    """Return whether the store has files of any job whose record fits a pattern of `glob`."""
    return any(iglob(f"{_folders_of(pattern)}/*"))  # noqa: PTH207 - the pattern has folders too


def _read_stored(keys: Keys, record: str) -> dict[str, Any]:
    """Return the record of a job's present key in the store; empty if the store lacks a table of the job."""
    if not _folders_of(record).is_dir():
        return {}
    folder = folder_of(record, keys.key(record))
    content = read_record(folder / record)
    fits = content.get("key") == keys.key(record) and keys.has_tables_of(content, folder)
    return content if fits else {}


def _folders_of(record: str) -> Path:
    return STORE / Path(record).relative_to("results").with_suffix("")


def _files_of(record: str, content: Mapping[str, Any]) -> list[str]:
    """Return the tables and the log of a job, then its record."""
    return [*filter(_is_of_a_job, (*content["tables"], content["log"])), record]


def _is_of_a_job(file: str) -> bool:
    """Return whether a job may write a path: a record may come from elsewhere and name any path."""
    is_named = file.startswith(_FOLDERS) and os.path.normpath(file) == file and "\0" not in file
    return is_named and (Path(file).suffix in _SUFFIXES or bool(_BLOCK_OF_MESHES.fullmatch(file)))


def _existing_records(folders: Iterable[str]) -> set[str]:
    return {
        os.path.join(place, name)  # noqa: PTH118 - thousands of files, and a Path takes longer
        for folder in folders
        for place, _, names in os.walk(folder)
        for name in names
        if name.endswith(".json")
    }


def _folders_in_store() -> Iterator[tuple[float, int, str]]:
    """Yield the time (s), size (bytes) and path of each folder that holds the files of a job."""
    for place, folders, _ in os.walk(STORE):
        for name in filter(_KEY.fullmatch, folders):
            path = Path(place, name)
            sizes = (file.lstat().st_size for file in path.rglob("*") if not file.is_dir())
            yield path.stat().st_mtime, sum(sizes), str(path)
        folders[:] = [name for name in folders if not _KEY.fullmatch(name)]


def _move_all(pairs: Iterable[tuple[Path, Path]]) -> None:
    """Move existing files and folders, and remove folders that are empty then; raise `StorageError` if a move fails."""
    for source, target in pairs:
        if not os.path.lexists(source):  # it lay in a folder that was moved
            continue
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            _remove(target)
            # `Path.rename` can't move between file systems.
            shutil.move(source, target)
        except OSError as error:
            raise StorageError(
                f"{source} can't be moved to {target}: {error.strerror or error}."
            ) from error
        with suppress(OSError):  # `rmdir` fails at the first folder that is not empty
            for folder in source.parents[:-2]:
                folder.rmdir()


def _remove(path: Path) -> None:
    """Remove a file or folder, if there is any: the rest of a move that was killed."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


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
