"""Files that are written whole or not at all."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from visuohaptic.base.errors import StorageError

_FULL_OR_READ_ONLY = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS}

_unfinished: set[Path] = set()


def storage_fault(error: BaseException | None, path: object) -> StorageError | None:
    """Return an error that names `path` if a disk is full, read-only or broken; None for other errors."""
    number = getattr(error, "errno", None)
    if number in _FULL_OR_READ_ONLY:
        return StorageError(f"{path} can't be written: {os.strerror(number)}.")
    if number == errno.EIO:
        return StorageError(f"{path} can't be read or written: {os.strerror(number)}.")
    return None


@contextmanager
def atomic_file(path: str | Path) -> Iterator[Path]:
    """Yield the path of an empty hidden file, and rename the file to `path` when the block ends.

    If the block raises, the hidden file is removed and an old file at `path` stays. Missing folders of `path` are
    created. The hidden name ends in random characters, so that readers of ``*.parquet`` do not find the file. Raises
    `StorageError` if the disk is full, read-only or broken.
    """
    path = Path(path)
    # A name may have 255 bytes, so the beginning of a long name is enough.
    beginning = path.name.encode()[:200].decode(errors="ignore")
    unfinished = path.with_name(f".{beginning}-{os.urandom(4).hex()}")
    _unfinished.add(unfinished)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.touch(mode=0o600, exist_ok=False)
        yield unfinished
        unfinished.chmod(0o644)
        unfinished.replace(path)
    except BaseException as error:
        # On a read-only disk nothing can be removed, and `error` says so.
        with suppress(OSError):
            unfinished.unlink(missing_ok=True)
        if fault := storage_fault(error, path):
            raise fault from error
        raise
    finally:
        _unfinished.discard(unfinished)


@contextmanager
def unfinished_folder(parent: Path) -> Iterator[Path]:
    """Yield a hidden folder in `parent`, and remove it with its content when the block ends.

    The caller moves finished files out of the folder within the block. Raises `StorageError` if the disk of `parent` is
    full, read-only or broken.
    """
    try:
        with TemporaryDirectory(dir=parent, prefix=".visuohaptic-") as name:
            _unfinished.add(Path(name))
            yield Path(name)
    except OSError as error:
        # A file of the hidden folder would tell the caller nothing.
        cause = error.__cause__ if isinstance(error, StorageError) else error
        if fault := storage_fault(cause, parent):
            raise fault from error
        raise


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
