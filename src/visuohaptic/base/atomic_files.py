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
    """Yield the path of an empty hidden file, and rename the file to `path` when the block ends.

    If the block raises, the hidden file is removed and an old file at `path` stays. Missing folders of `path` are
    created. The hidden name ends in random characters, so that readers of ``*.parquet`` do not find the file.
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
def unfinished_folder(parent: Path) -> Iterator[Path]:
    """Yield a hidden folder in `parent`, and remove it with its content when the block ends.

    The caller moves finished files out of the folder within the block.
    """
    with TemporaryDirectory(dir=parent, prefix=".visuohaptic-") as name:
        _unfinished.add(Path(name))
        yield Path(name)


def remove_unfinished() -> None:
    """Remove the hidden files and folders that this process is writing; for a process that ends by ``os._exit``."""
    for unfinished in list(_unfinished):
        if unfinished.is_dir():
            shutil.rmtree(unfinished)
        else:
            unfinished.unlink(missing_ok=True)


def atomic_write_text(path: str | Path, text: str) -> None:
    """Write a text file as UTF-8 through `atomic_file`."""
    with atomic_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
