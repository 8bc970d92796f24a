"""What files hold: their SHA-256, remembered as long as nothing about a file has changed."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

from visuohaptic.base.atomic_files import atomic_write_text

TIMESTAMP = ".snakemake_timestamp"
"""The file in a folder that is an output by whose time Snakemake judges it."""

_YOUNG_NS = 2_000_000_000
"""A file may change again without another time as long as it is younger than this, so it is read again."""


def stamp(path: str | Path) -> tuple[int, ...]:
    """Give what changes with a file, whatever its time is set to: size, inode, times of content and of change."""
    found = Path(path).stat()
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
        path = Path(path)
        if path.is_dir():
            files = sorted(file for file in path.rglob("*") if file.is_file())
            named = {
                str(file.relative_to(path)): self.of(file)
                for file in files
                if file.name != TIMESTAMP
            }
            return hashlib.sha256(json.dumps(named, sort_keys=True).encode()).hexdigest()
        key, now = str(path.absolute()), list(stamp(path))
        known = self._known.get(key)
        if known is not None and known[0] == now:
            return str(known[1])
        with path.open("rb") as stream:
            found = hashlib.file_digest(stream, "sha256").hexdigest()
        if path.suffix == ".py" and (known is None or known[1] != found):
            # Python would take bytecode for current that was made in the same second from as many bytes.
            Path(importlib.util.cache_from_source(key)).unlink(missing_ok=True)
        young = max(now[2:]) > time.time_ns() - _YOUNG_NS
        self._known[key] = [[] if young else now, found]
        self._changed = True
        return found

    def save(self) -> None:
        """Keep what is known, where a file for it was named and can be written."""
        if self._memory is not None and self._changed:
            with suppress(OSError):
                atomic_write_text(self._memory, json.dumps(self._known))


def stamps_of(files: Iterable[str | Path]) -> str:
    """Sum up the stamps of files, to see later whether one was touched; a missing one counts, too."""
    paths = [Path(file) for file in files]
    found = [[str(path), stamp(path) if path.exists() else None] for path in paths]
    return hashlib.sha256(json.dumps(found).encode()).hexdigest()
