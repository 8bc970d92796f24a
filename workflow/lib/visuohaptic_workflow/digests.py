"""What files hold: their SHA-256, remembered as long as nothing about a file has changed."""

from __future__ import annotations

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
"""The file in a folder that is an output by whose time Snakemake judges it."""

_YOUNG_NS = 2_000_000_000
"""A file may change again without another time as long as it is younger than this, so it is read again."""


Stamp = tuple[int, ...]


def stamp(path: str | Path) -> Stamp:
    """Return what changes with a file, whatever its time is set to: size, inode, times of content and of change."""
    return stamp_of(os.stat(path))  # noqa: PTH116 - thousands of times, and a Path takes longer than the kernel


def stamp_of(found: os.stat_result) -> Stamp:
    """Return the stamp of a file whose status the kernel gave."""
    return (found.st_size, found.st_ino, found.st_mtime_ns, found.st_ctime_ns)


class Digests:
    """SHA-256 of files; the file `memory` keeps them between processes, unless it is damaged."""

    def __init__(self, memory: str | Path | None = None) -> None:
        self._memory = memory
        self._known: dict[str, Any] = {}
        self._changed = False
        if memory is not None:
            with suppress(OSError, ValueError, TypeError):
                self._known = dict(json.loads(Path(memory).read_text(encoding="utf-8")))

    def of(self, path: str | Path) -> str:
        """Give the SHA-256 of a file, or of a folder's files and their names; raises `OSError` if it can't be read."""
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
        key, now = _key_of(path), list(stamp_of(status))
        known = self._known.get(key)
        if known is not None and known[0] == now:
            return str(known[1])
        path = Path(path)
        with path.open("rb") as stream:
            found = hashlib.file_digest(stream, "sha256").hexdigest()
        if path.suffix == ".py" and (known is None or known[1] != found):
            # Python would take bytecode for current that was made in the same second from as many bytes.
            Path(importlib.util.cache_from_source(key)).unlink(missing_ok=True)
        young = max(now[2:]) > time.time_ns() - _YOUNG_NS
        self._known[key] = [[] if young else now, found]
        self._changed = True
        return found

    def remembered(self, find: Callable[[Path], Sequence[str]], path: Path) -> Sequence[str]:
        """Return the strings that `find` reads from a file, remembered as long as the file has this content.

        Only one `find` is remembered per file.
        """
        self.of(path)
        known = self._known[_key_of(path)]
        if len(known) == 2:  # without what `find` read
            known.append(find(path))
            self._changed = True
        return list(known[2])

    def save(self) -> None:
        """Keep what is known, where a file for it was named and can be written."""
        if self._memory is not None and self._changed:
            with suppress(OSError):
                atomic_write_text(self._memory, json.dumps(self._known))


def _key_of(path: str | Path) -> str:
    return os.path.join(os.getcwd(), path)  # noqa: PTH109, PTH118 - as in `stamp`


def stamp_if_there(path: str | Path) -> Stamp | None:
    """Return the stamp of a file; None for a file that is missing."""
    with suppress(FileNotFoundError, NotADirectoryError):
        return stamp(path)
    return None


def stamps_of(
    files: Iterable[str], find_stamp: Callable[[str], Stamp | None] = stamp_if_there
) -> str:
    """Return the digest of the stamps of files, to see later whether one was touched or removed."""
    found = [[file, find_stamp(file)] for file in files]
    return hashlib.sha256(json.dumps(found).encode()).hexdigest()
