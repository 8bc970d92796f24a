"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

_unfinished: set[Path] = set()


@contextmanager
def atomic_file(path: str | Path) -> Iterator[Path]:
    """Give an empty file beside a path, which takes its place once it is written; its folder is made.

    A reader finds the old file or the new one; where writing fails, the old one stays. The hidden name has
    no suffix that a reader of tables would take.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}-{os.urandom(4).hex()}")
    _unfinished.add(unfinished)
    try:
        unfinished.touch(mode=0o600, exist_ok=False)
        yield unfinished
        unfinished.chmod(0o644)
        unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
    finally:
        _unfinished.discard(unfinished)


@contextmanager
def unfinished_folder(place: Path) -> Iterator[Path]:
    """Give a hidden folder in a place, for files that leave it once all are written; then it is removed."""
    with TemporaryDirectory(dir=place, prefix=".visuohaptic-") as name:
        _unfinished.add(Path(name))
        yield Path(name)


def remove_unfinished() -> None:
    """Remove what is being written in this process, before it ends at once."""
    for unfinished in list(_unfinished):
        if unfinished.is_dir():
            shutil.rmtree(unfinished)
        else:
            unfinished.unlink(missing_ok=True)


def atomic_write_text(path: str | Path, text: str) -> None:
    """Write a UTF-8 text file whole or not at all."""
    with atomic_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
