"""Keys: what made a job's files, in one digest, and whether the same would be made today.

A key is the digest of a job's code (`code_of_jobs.CODE`), the versions of the packages that this imports, its parameters, the content of its
sources, and the keys of the jobs that it takes from. A job's record is the last of its files: the parts of its key, and
the digests of its tables. The record fits if its key is today's and each table has its digest. Times say nothing.
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
"""The reason to run a job none of whose files is there."""

NO_RECORD = "record: missing or of another version"
"""The reason to run a job that has at least one table, but no record."""


@dataclass(frozen=True)
class Job:
    """One job of a rule.

    `record`, one of its outputs, says what made the others; `find_params` gives the parameters that decide what they
    hold, of built-in types.
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
        """Its files but the record."""
        return [file for file in self.outputs if file != self.record]


def key_of(parts: Mapping[str, Any]) -> str:
    """Give the key of its parts: 64 hexadecimal digits."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def read_record(path: str | Path) -> dict[str, Any]:
    """Read a record; an empty one where it is missing, or is none."""
    try:
        record = json.loads(Path(path).read_text(encoding="utf-8"))
        return record if {"key", "parts", "tables", "log"} <= record.keys() else {}
    except (OSError, ValueError, AttributeError):
        return {}


class Keys:
    """The keys of all jobs that today's parameters and objects ask for, each fixed when it is first asked for.

    Files of the clone, `root`, have the same names wherever the run is. Jobs with a record in `kept` are left as they
    are: other jobs that take from them take what is there.
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
        """Name the records of the jobs that make some files, each once."""
        return {self._makers[file]: None for file in files if file in self._makers}

    @cache  # noqa: B019 - a process has one such object, or few
    def parts(self, record: str) -> Parts:
        """Give the parts of a job's key.

        ``code`` and ``sources``: digests by file; ``packages``: versions; ``parameters``; ``from``: the key of each
        job that it takes from, by record.
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
        """Give a job's key."""
        return key_of(self.parts(record))

    def given(self, record: str) -> Parts:
        """Give what a job checks itself by: its key's parts, its files of code and sources, and what marks these today."""
        code = self._code_files(self.jobs[record].runs)
        files = {"code": code, "sources": self._sources(record)}
        stamps = stamps_of([*code, *files["sources"]], self._stamp)
        return {"parts": self.parts(record), "files": files, "stamps": stamps}

    @cache  # noqa: B019
    def reason(self, record: str) -> str | None:
        """Say why a job's files are not what it would make today; None where they are."""
        kept, tables = read_record(record), self.jobs[record].tables
        if not kept:
            return NO_RECORD if any(map(os.path.exists, tables)) else NEW
        if kept["key"] != self.key(record):
            return self._difference(kept["parts"], self.parts(record))
        edited = (file for file in tables if self._digest(file) != kept["tables"].get(file))
        return next((f"table: {file}" for file in edited), None)

    def why(self, record: str) -> str | None:
        """Give the reason to run a job; None for one whose files are today's, or are left as they are."""
        return None if record in self.kept else self.reason(record)

    @cache  # noqa: B019
    def stale_behind(self, record: str) -> set[str]:
        """Name the records of stale jobs from which a job is parted by current ones alone.

        From a job that runs Snakemake goes on to those that take its files, and passes over all others behind it
        (https://github.com/snakemake/snakemake/issues/4166): a stale job must take something of these itself.
        """
        current = [maker for maker in self._makers_of(record) if self.why(maker) is None]
        nearest = {one for maker in current for one in self._makers_of(maker) if self.why(one)}
        return nearest.union(*map(self.stale_behind, current))

    def needed_for(self, files: Iterable[str]) -> list[str]:
        """Name the records of all jobs behind some files, in no order of work."""
        found: dict[str, None] = {}
        waiting = list(self.makers(files))
        while waiting:
            record = waiting.pop()
            if record not in found:
                found[record] = None
                waiting += self._makers_of(record)
        return list(found)

    def is_unchanged(self, record: str) -> bool:
        """Return whether code, sources and tables of a job that fits still have the digests of its key and record."""
        parts, tables = self.parts(record), read_record(record).get("tables", {})
        code = self._digests_of(self._find_code(self.jobs[record].runs).files)
        sources = self._digests_of(self._sources(record))
        found = {file: self._digest(file) for file in tables}
        return (code, sources, found) == (parts["code"], parts["sources"], tables)

    def _makers_of(self, record: str) -> dict[str, None]:
        return self.makers(self.jobs[record].inputs)

    def _difference(self, kept: Parts, today: Parts) -> str:
        for part, name in (
            ("parameters", "parameters"),
            ("sources", "source"),
            ("code", "code"),
            ("packages", "packages"),
        ):
            if (place := _first_difference(kept.get(part, {}), today[part])) is not None:
                return f"{name}: {place.removeprefix('parameters.')}"
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
        """Return the path of a file of the clone relative to the clone; of another file as it was named."""
        # Made absolute without following links.
        path, root = os.path.abspath(file), f"{self._root}{os.sep}"  # noqa: PTH100
        return path.removeprefix(root) if path.startswith(root) else str(file)

    def _digest(self, file: str | Path) -> str:
        try:
            return self._digests.of(file)
        except OSError:
            return "missing"


def _first_difference(kept: Any, today: Any, place: str = "") -> str | None:
    """Return the path of the first value that differs, such as ``sensor.largest_size``, or None if all are equal.

    If both values are lists of names, or only one of two mappings has a name, the path ends with this name.
    """
    if kept == today:
        return None
    if isinstance(kept, dict) and isinstance(today, dict):
        for name in [*today, *kept]:
            if (name in kept) != (name in today):
                return f"{place}.{name}".removeprefix(".")
            if kept[name] != today[name]:
                return _first_difference(kept[name], today[name], f"{place}.{name}")
    if isinstance(kept, list) and isinstance(today, list):
        for name in [*today, *kept]:
            if isinstance(name, str) and (name in kept) != (name in today):
                return f"{place}.{name}".removeprefix(".")
    return place.removeprefix(".")
