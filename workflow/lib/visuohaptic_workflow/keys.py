"""Keys of jobs: digests of everything that determines a job's files.

The parts of a key are the job's code (`code_of_jobs.CODE`), versions of imported packages, parameters, the content of
source files (inputs that no job makes), and the keys of the jobs that make the other inputs. A job writes its record
last. The record contains the key, its parts, the digests of the job's tables, and the path of its log.

A record is current if its key equals the key that `Keys` computes now, and each table has the recorded digest;
otherwise the record and its job are stale. Times of files have no effect. A job is upstream of each job that reads its
outputs, directly or through other jobs.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from visuohaptic_workflow.code_of_jobs import Code, Runs
from visuohaptic_workflow.digests import Digests, Stamp, stamp_if_there, stamps_of

Parts = dict[str, Any]
"""The parts of a key by name, as `Keys.parts` returns them."""

NEW = "new"
"""The reason to run a job that has neither a readable record nor any table."""

NO_RECORD = "record: missing or of another version"
"""The reason to run a job that has at least one table, but no record."""


@dataclass(frozen=True)
class Job:
    """A job of a rule. Paths are absolute or relative to the working directory.

    Attributes
    ----------
    rule : str
        Name of the rule.
    wildcards : mapping of str to str
        Values of the rule's wildcards.
    runs : Runs
        The script of the job, the row of `code_of_jobs.CODE`, and modules outside of the library.
    outputs : tuple of str
        Paths of the files or folders that the job writes, with `record`.
    record : str
        Path of the job's record, which also identifies the job in `Keys`.
    find_inputs : callable
        Returns the paths of the files or folders that the job reads.
    find_params : callable
        Returns the values of the parameters in the key, by name. JSON must be able to store the values.
    """

    rule: str
    wildcards: Mapping[str, str]
    runs: Runs
    outputs: tuple[str, ...]
    record: str
    find_inputs: Callable[[], Iterable[str]]
    find_params: Callable[[], dict[str, Any]]

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Paths of the files or folders that the job reads."""
        return tuple(self.find_inputs())

    @cached_property
    def tables(self) -> list[str]:
        """Paths of the outputs except the record."""
        return [file for file in self.outputs if file != self.record]


def key_of(parts: Mapping[str, Any]) -> str:
    """Compute a key, 64 hexadecimal digits, from its parts."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def read_record(path: str | Path) -> dict[str, Any]:
    """Read a record: a dict with ``key``, ``parts``, ``tables`` (digests by path) and ``log`` (a path).

    Returns an empty dict if the file is missing, unreadable, or without one of these names, or if a value has another type.
    """
    try:
        record = json.loads(Path(path).read_text(encoding="utf-8"))
        named = [record["tables"], record["parts"], *record["parts"].values()]
        is_record = all(isinstance(value, dict) for value in named)
        return record if is_record and "key" in record and isinstance(record["log"], str) else {}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}


class Keys:
    """The keys of all jobs of a workflow, and whether the files of the jobs are current.

    Methods identify a job by the path of its record. Parts, keys, reasons and stale records are computed at first use
    and cached, so later changes of files or parameters need a new object. Only `is_unchanged` checks files again.

    Parameters
    ----------
    jobs : iterable of Job
        All jobs of the current parameters and objects.
    find_code : callable
        Returns the `Code` (files and versions of packages) of a job's `Runs`.
    digests : Digests
        Computes and caches the SHA-256 of files.
    root : Path
        Absolute path of the clone of this repository. Keys name files of the clone relative to this folder.
    find_former : callable
        Returns the record of a job, named by its path, that an earlier run made and that is no longer there; an empty
        dict without one.
    """

    def __init__(
        self,
        jobs: Iterable[Job],
        find_code: Callable[[Runs], Code],
        digests: Digests,
        root: Path,
        find_former: Callable[[str], dict[str, Any]] = lambda _: {},
    ) -> None:
        self.jobs = {job.record: job for job in jobs}
        self._find_code, self._digests = find_code, digests
        self._root, self._find_former = root, find_former
        self._makers = {file: job.record for job in self.jobs.values() for file in job.outputs}

    def makers(self, files: Iterable[str]) -> dict[str, None]:
        """Return the records of the jobs that make some files, as keys of a dict; skip files that no job makes."""
        return {self._makers[file]: None for file in files if file in self._makers}

    @cache  # noqa: B019 - a process has one such object, or few
    def parts(self, record: str) -> Parts:
        """Return the parts of a job's key.

        ``code`` and ``sources`` are digests by file, or ``missing``. ``packages`` are versions by name. ``parameters``
        are values by name; ``wildcards`` has the values of the wildcards. ``from`` are the keys, by record, of the jobs that make
        the inputs.
        """
        job = self.jobs[record]
        return {
            "code": self._code_digests(job.runs),
            "packages": self._find_code(job.runs).versions,
            "parameters": json.loads(
                json.dumps({**job.find_params(), "wildcards": dict(job.wildcards)})
            ),
            "sources": self._digests_of(self._sources(record)),
            "from": {maker: self.key(maker) for maker in self.makers(job.inputs)},
        }

    @cache  # noqa: B019
    def key(self, record: str) -> str:
        """Return a job's key, computed now; the record may contain another key."""
        return key_of(self.parts(record))

    def snapshot(self, record: str) -> dict[str, Any]:
        """Return the state of a job when the run is planned, for `records.check_inputs` in the job.

        ``parts`` are the parts of the key. ``files`` has the lists ``code`` and ``sources`` of paths. ``stamps`` is one
        digest over the stamps of all these files (`digests.stamps_of`).
        """
        code = self._code_files(self.jobs[record].runs)
        files = {"code": code, "sources": self._sources(record)}
        stamps = stamps_of([*code, *files["sources"]], self._stamp)
        return {"parts": self.parts(record), "files": files, "stamps": stamps}

    @cache  # noqa: B019
    def reason_not_current(self, record: str) -> str | None:
        """Return why a job's files are not current; None if they are current.

        Only the first difference is named, such as ``parameters: sensor.size``, ``code: <file>`` or ``table: <file>``;
        `NEW` if the job has neither record nor table, and no former record to compare with. If only the key of a job upstream differs, the result is the
        reason of that job, or ``from: <rule>`` if that job is current but ran after this job, or has lost its files.
        """
        recorded, tables = read_record(record), self.jobs[record].tables
        if not recorded and any(map(os.path.exists, tables)):
            return NO_RECORD
        if not recorded:
            former = self._find_former(record)
            has_other_key = bool(former) and former["key"] != self.key(record)
            return self._difference(former["parts"], self.parts(record)) if has_other_key else NEW
        if recorded["key"] != self.key(record):
            return self._difference(recorded["parts"], self.parts(record))
        edited = (file for file in tables if self._digest(file) != recorded["tables"].get(file))
        return next((f"table: {file}" for file in edited), None)

    def needed_for(self, files: Iterable[str], stale: Collection[str] | None = None) -> list[str]:
        """Return the records of the jobs that make some files, and of all jobs upstream; the order is arbitrary.

        With `stale`, return only records in `stale`: a current job does not need the jobs upstream of it.
        """
        needed: dict[str, None] = {}
        waiting = list(self.makers(files))
        while waiting:
            record = waiting.pop()
            if record not in needed and (stale is None or record in stale):
                needed[record] = None
                waiting += self._makers_of(record)
        return list(needed)

    def inputs_of(self, records: Iterable[str]) -> dict[str, None]:
        """Return the inputs of some jobs as keys of a dict."""
        return {file: None for record in records for file in self.jobs[record].inputs}

    def is_unchanged(self, record: str) -> bool:
        """Read a current job's files again; return whether code and sources match its key, and tables its record."""
        parts, tables = self.parts(record), read_record(record).get("tables", {})
        code = self._digests_of(self._find_code(self.jobs[record].runs).files)
        sources = self._digests_of(self._sources(record))
        digests = {file: self._digest(file) for file in tables}
        return (code, sources, digests) == (parts["code"], parts["sources"], tables)

    def has_tables_of(self, recorded: Mapping[str, Any], folder: Path = Path()) -> bool:
        """Return whether each table of a record has the recorded digest; paths of tables are relative to `folder`."""
        return all(
            self._digest(folder / file) == digest for file, digest in recorded["tables"].items()
        )

    def _makers_of(self, record: str) -> dict[str, None]:
        """Return the records of the jobs that make a job's inputs."""
        return self.makers(self.jobs[record].inputs)

    def _difference(self, recorded: Parts, now: Parts) -> str:
        """Return the first difference of the recorded parts from the present parts, as a reason."""
        for part, name in (
            ("parameters", "parameters"),
            ("sources", "source"),
            ("code", "code"),
            ("packages", "packages"),
        ):
            if (path := _first_difference(recorded.get(part, {}), now[part])) is not None:
                return f"{name}: {path.removeprefix('parameters.')}"
        for maker, key in now["from"].items():
            if recorded.get("from", {}).get(maker) != key:
                reason = self.reason_not_current(maker)
                return f"from: {self.jobs[maker].rule}" if reason in {None, NEW} else reason
        return "from: other files"

    @cache  # noqa: B019
    def _code_digests(self, runs: Runs) -> dict[str, str]:
        """Return the digests of the files of code by name in keys."""
        return dict(map(self._named_digest, self._find_code(runs).files))

    @cache  # noqa: B019
    def _code_files(self, runs: Runs) -> list[str]:
        """Return the files of code, relative to the working directory, in the order of `_code_digests`."""
        return [self._relative_to_cwd(file) for file in self._find_code(runs).files]

    @cache  # noqa: B019
    def _relative_to_cwd(self, file: Path) -> str:
        return os.path.relpath(file)

    @cache  # noqa: B019 - most files of code belong to several rules
    def _named_digest(self, file: str | Path) -> tuple[str, str]:
        """Return a file's name in keys and its digest."""
        return self._name_in_keys(file), self._digest(file)

    @cache  # noqa: B019
    def _stamp(self, file: str) -> Stamp | None:
        return stamp_if_there(file)

    def _sources(self, record: str) -> list[str]:
        """Return a job's inputs that no job makes."""
        return [file for file in self.jobs[record].inputs if file not in self._makers]

    def _digests_of(self, files: Iterable[str | Path]) -> dict[str, str]:
        """Return the digests of files by name in keys."""
        return {self._name_in_keys(file): self._digest(file) for file in files}

    def _name_in_keys(self, file: str | Path) -> str:
        """Return the path relative to `root` for a file of the clone; otherwise the given path."""
        # os.path.abspath does not follow links.
        path, root = os.path.abspath(file), f"{self._root}{os.sep}"  # noqa: PTH100
        return path.removeprefix(root) if path.startswith(root) else str(file)

    def _digest(self, file: str | Path) -> str:
        """Return a file's SHA-256; ``missing`` if the file cannot be read."""
        try:
            return self._digests.of(file)
        except (OSError, ValueError):  # ValueError: a name that no file can have
            return "missing"


def _first_difference(recorded: Any, now: Any, path: str = "") -> str | None:
    """Return the dotted name of the first different value or list entry, such as ``sensor.largest_size``, or None."""
    if recorded == now:
        return None
    if isinstance(recorded, dict) and isinstance(now, dict):
        for name in [*now, *recorded]:
            if (name in recorded) != (name in now):
                return f"{path}.{name}".removeprefix(".")
            if recorded[name] != now[name]:
                return _first_difference(recorded[name], now[name], f"{path}.{name}")
    if isinstance(recorded, list) and isinstance(now, list):
        for name in [*now, *recorded]:
            if isinstance(name, str) and (name in recorded) != (name in now):
                return f"{path}.{name}".removeprefix(".")
    return path.removeprefix(".")
