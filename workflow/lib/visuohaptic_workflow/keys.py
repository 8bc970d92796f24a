"""Keys of jobs: digests of everything that determines a job's files.

The parts of a key are the job's code (`code_of_jobs.CODE`), versions of imported packages, parameters, the content of
source files, and the keys of the jobs that made its other inputs. A job writes its record last: the parts of its key,
and the digests of its tables. A record is current if its key is the current key and each table has its digest. Times of
files do not count.
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

NEW = "new"
"""The reason to run a job without any existing file."""


@dataclass(frozen=True)
class Job:
    """A job of a rule.

    Attributes
    ----------
    rule : str
        Name of the rule.
    wildcards : mapping of str to str
        Values of the rule's wildcards.
    runs : Runs
        The code of the job.
    inputs, outputs : tuple of str
        Files.
    record : str
        The output with the parts of the job's key and the digests of its tables.
    find_params : callable
        Returns the parameters in built-in types.
    """

    rule: str
    wildcards: Mapping[str, str]
    runs: Runs
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    record: str
    find_params: Callable[[], dict[str, Any]]

    @cached_property
    def tables(self) -> list[str]:
        """The outputs without the record."""
        return [file for file in self.outputs if file != self.record]


def key_of(parts: Mapping[str, Any]) -> str:
    """Compute a key from its parts: 64 hexadecimal digits."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def read_record(path: str | Path) -> dict[str, Any]:
    """Read a record. Returns an empty dict if the file is missing or no record."""
    try:
        record = json.loads(Path(path).read_text(encoding="utf-8"))
        return record if {"key", "parts", "tables", "log"} <= record.keys() else {}
    except (OSError, ValueError, AttributeError):
        return {}


class Keys:
    """The keys of all current jobs; each key is computed at first use and cached.

    Parameters
    ----------
    jobs : iterable of Job
        All jobs of the current parameters and objects.
    find_code : callable
        Returns the `Code` of `Runs`.
    digests : Digests
        Digests of files.
    root : Path
        The clone. In keys, files of the clone have names relative to this folder.
    kept : collection of str
        Records of jobs that are not to run again. Jobs behind them use the existing files.
    """

    def __init__(
        self,
        jobs: Iterable[Job],
        find_code: Callable[[Runs], Code],
        digests: Digests,
        root: Path,
        kept: Collection[str] = (),
    ) -> None:
        self.jobs = {job.record: job for job in jobs}
        self._find_code, self._digests = find_code, digests
        self._root, self.kept = root, frozenset(kept)
        self._makers = {file: job.record for job in self.jobs.values() for file in job.outputs}

    def makers(self, files: Iterable[str]) -> dict[str, None]:
        """Return the records of the jobs that make some files, each once."""
        return {self._makers[file]: None for file in files if file in self._makers}

    @cache  # noqa: B019 - a process has one such object, or few
    def parts(self, record: str) -> Parts:
        """Return the parts of a job's key.

        ``code`` and ``sources`` are digests by file, ``packages`` versions by name, ``parameters`` values by name,
        and ``from`` keys of the jobs behind the inputs by record.
        """
        job = self.jobs[record]
        return {
            "code": self._code_of(job.runs),
            "packages": self._find_code(job.runs).versions,
            "parameters": json.loads(json.dumps({**job.find_params(), **job.wildcards})),
            "sources": self._digests_of(self._sources(record)),
            "from": {maker: self._key_taken(maker, record) for maker in self.makers(job.inputs)},
        }

    @cache  # noqa: B019
    def key(self, record: str) -> str:
        """Return a job's key."""
        return key_of(self.parts(record))

    def snapshot(self, record: str) -> Parts:
        """Return the parts of a job's key, its files of code and sources, and their stamps, for checks in the job."""
        code = self._code_files(self.jobs[record].runs)
        files = {"code": code, "sources": self._sources(record)}
        stamps = stamps_of([*code, *files["sources"]], self._stamp)
        return {"parts": self.parts(record), "files": files, "stamps": stamps}

    @cache  # noqa: B019
    def reason(self, record: str) -> str | None:
        """Return why a job's files are not current; None if they are."""
        kept, tables = read_record(record), self.jobs[record].tables
        if not kept:
            return "record: none of this version" if any(map(os.path.exists, tables)) else NEW
        if kept["key"] != self.key(record):
            return self._difference(kept["parts"], self.parts(record))
        edited = (file for file in tables if self._digest(file) != kept["tables"].get(file))
        return next((f"table: {file}" for file in edited), None)

    def why(self, record: str) -> str | None:
        """Return the reason to run a job; None if its files are current or kept."""
        return None if record in self.kept else self.reason(record)

    @cache  # noqa: B019
    def stale_behind(self, record: str) -> set[str]:
        """Return the records of stale jobs that only current jobs separate from a job.

        Snakemake runs a job after a rerun of its direct inputs, but not of stale jobs behind current jobs
        (https://github.com/snakemake/snakemake/issues/4166). So these records must become direct inputs.
        """
        current = [maker for maker in self._makers_of(record) if self.why(maker) is None]
        nearest = {
            stale for maker in current for stale in self._makers_of(maker) if self.why(stale)
        }
        return nearest.union(*map(self.stale_behind, current))

    def needed_for(self, files: Iterable[str]) -> list[str]:
        """Return the records of all jobs behind some files, in no particular order."""
        needed: dict[str, None] = {}
        waiting = list(self.makers(files))
        while waiting:
            record = waiting.pop()
            if record not in needed:
                needed[record] = None
                waiting += self._makers_of(record)
        return list(needed)

    def is_unchanged(self, record: str) -> bool:
        """Return whether code, sources and tables of a current job still have the digests of its key and record."""
        parts, tables = self.parts(record), read_record(record).get("tables", {})
        code = self._digests_of(self._find_code(self.jobs[record].runs).files)
        sources = self._digests_of(self._sources(record))
        digests = {file: self._digest(file) for file in tables}
        return (code, sources, digests) == (parts["code"], parts["sources"], tables)

    def _makers_of(self, record: str) -> dict[str, None]:
        return self.makers(self.jobs[record].inputs)

    def _difference(self, kept: Parts, today: Parts) -> str:
        for part, name in (
            ("parameters", "parameters"),
            ("sources", "source"),
            ("code", "code"),
            ("packages", "packages"),
        ):
            if (path := _first_difference(kept.get(part, {}), today[part])) is not None:
                return f"{name}: {path}"
        for maker, key in today["from"].items():
            if kept.get("from", {}).get(maker) != key:
                return self.reason(maker) or f"from: {self.jobs[maker].rule}"
        return "from: other files"

    def _key_taken(self, maker: str, taker: str) -> str:
        if maker in self.kept and taker not in self.kept and (kept := read_record(maker)):
            return str(kept["key"])
        return self.key(maker)

    @cache  # noqa: B019
    def _code_of(self, runs: Runs) -> dict[str, str]:
        return dict(map(self._named_digest, self._find_code(runs).files))

    @cache  # noqa: B019
    def _code_files(self, runs: Runs) -> list[str]:
        return [self._relative(file) for file in self._find_code(runs).files]

    @cache  # noqa: B019
    def _relative(self, file: Path) -> str:
        return os.path.relpath(file)

    @cache  # noqa: B019 - most files of code belong to several rules
    def _named_digest(self, file: str | Path) -> tuple[str, str]:
        return self._name(file), self._digest(file)

    @cache  # noqa: B019
    def _stamp(self, file: str) -> Stamp | None:
        return stamp_if_there(file)

    def _sources(self, record: str) -> list[str]:
        return [file for file in self.jobs[record].inputs if file not in self._makers]

    def _digests_of(self, files: Iterable[str | Path]) -> dict[str, str]:
        return {self._name(file): self._digest(file) for file in files}

    def _name(self, file: str | Path) -> str:
        """Return the path relative to the clone for files of the clone, else the given path."""
        # os.path.abspath does not follow links.
        path, root = os.path.abspath(file), f"{self._root}{os.sep}"  # noqa: PTH100
        return path.removeprefix(root) if path.startswith(root) else str(file)

    def _digest(self, file: str | Path) -> str:
        try:
            return self._digests.of(file)
        except OSError:
            return "missing"


def _first_difference(kept: Any, today: Any, path: str = "") -> str | None:
    """Return the path of the first difference of two values, such as ``sensor.largest_size``; None if equal."""
    if kept == today:
        return None
    if isinstance(kept, dict) and isinstance(today, dict):
        for name in [*today, *kept]:
            if kept.get(name) != today.get(name):
                return _first_difference(kept.get(name), today.get(name), f"{path}.{name}")
    return path.removeprefix(".")
