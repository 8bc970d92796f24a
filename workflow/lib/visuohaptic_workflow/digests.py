"""SHA-256 of files, cached until the status of a file changes."""

from __future__ import annotations

import errno
import hashlib
import importlib.util
import json
import os
import stat
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from visuohaptic.base.atomic_files import atomic_write_text

TIMESTAMP = ".snakemake_timestamp"
"""The file whose time Snakemake takes as the time of an output folder."""

_YOUNG_NS = 2_000_000_000
"""Younger files, in nanoseconds, are not cached: a further change may leave their times as they are."""

Stamp = tuple[int, ...]


def stamp(path: str | Path) -> Stamp:
    """Return size, inode, and times of content and of change: at least one of them changes with the file."""
    return stamp_of(os.stat(path))  # noqa: PTH116 - thousands of calls, and a Path takes longer than the kernel


def stamp_of(status: os.stat_result) -> Stamp:
    """Return the stamp of a file by its status."""
    return (status.st_size, status.st_ino, status.st_mtime_ns, status.st_ctime_ns)


class Digests:
    """SHA-256 of files, cached in the file `memory` between processes; a damaged cache is ignored."""

    def __init__(self, memory: str | Path | None = None) -> None:
        self._memory = memory
        self._known: dict[str, Any] = {}
        self._changed = False
        if memory is not None:
            with suppress(OSError, ValueError, TypeError):
                self._known = dict(json.loads(Path(memory).read_text(encoding="utf-8")))

    def of(self, path: str | Path) -> str:
        """Return the SHA-256 of a file, or of a folder's files and their names.

        Raises `OSError` as `open`, and for pipes and devices.
        """
        status = os.stat(path)  # noqa: PTH116 - as in `stamp`
        if stat.S_ISDIR(status.st_mode):
            path = Path(path)
            files = sorted(file for file in path.rglob("*") if file.is_file())
            named = {
                str(file.relative_to(path)): self.of(file)
                for file in files
                if file.name != TIMESTAMP
            }
            return hashlib.sha256(json.dumps(named, sort_keys=True).encode()).hexdigest()
        if not stat.S_ISREG(status.st_mode):  # a pipe or a device may never end
            raise OSError(errno.EINVAL, "is no regular file", str(path))
        key, now = _key_of(path), list(stamp_of(status))
        known = self._known.get(key)
        if known is not None and known[0] == now:
            return str(known[1])
        path = Path(path)
        with path.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
        if path.suffix == ".py" and (known is None or known[1] != digest):
            # Python can't tell bytecode from an edit in the same second with the same number of bytes. Where nothing may
            # be removed, such as on a read-only disk, nothing is edited either.
            with suppress(OSError):
                Path(importlib.util.cache_from_source(key)).unlink(missing_ok=True)
        young = max(now[2:]) > time.time_ns() - _YOUNG_NS
        self._known[key] = [[] if young else now, digest]
        self._changed = True
        return digest

    def read_cached(self, read: Callable[[Path], Sequence[str]], path: Path) -> Sequence[str]:
        """Return `read(path)`, cached until the content of the file changes.

        Always pass the same `read` for a file: the cache has one entry per file.
        """
        self.of(path)
        known = self._known[_key_of(path)]
        if len(known) == 2:  # stamp and digest, not yet the result of `read`
            known.append(read(path))
            self._changed = True
        return list(known[2])

    def save(self) -> None:
        """Write the cache to the file `memory`, if there is such a file name and the file can be written."""
        if self._memory is not None and self._changed:
            with suppress(OSError):
                atomic_write_text(self._memory, json.dumps(self._known))


def _key_of(path: str | Path) -> str:
    return os.path.join(os.getcwd(), path)  # noqa: PTH109, PTH118 - as in `stamp`


def stamp_if_there(path: str | Path) -> Stamp | None:
    """Return the stamp of a file; None for a missing file."""
    with suppress(FileNotFoundError, NotADirectoryError):
        return stamp(path)
    return None


def stamps_of(
    files: Iterable[str], find_stamp: Callable[[str], Stamp | None] = stamp_if_there
) -> str:
    """Return a digest of the stamps of files, which changes if any file is written or removed."""
    stamps = [[file, find_stamp(file)] for file in files]
    return hashlib.sha256(json.dumps(stamps).encode()).hexdigest()
