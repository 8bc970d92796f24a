"""Opening of files that users name: only regular files, because reading a pipe or a device may never end."""

from __future__ import annotations

import errno
import io
import os
import stat
from pathlib import Path
from typing import IO, BinaryIO

_BLOCK_BYTES = 1 << 20
_KINDS = (
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def check_regular(path: str | Path) -> None:
    """Raise `OSError` unless `path` names a regular file, or a link to one; `strerror` is the reason."""
    mode = os.stat(path).st_mode  # noqa: PTH116 - for texts and paths
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(mode):
        kind = next((kind for is_kind, kind in _KINDS if is_kind(mode)), "no file")
        raise OSError(errno.EINVAL, f"it is {kind}, and a regular file is needed", str(path))


def open_regular(path: str | Path) -> BinaryIO:
    """Open a regular file to read bytes; raises `OSError` as `check_regular` does."""
    check_regular(path)
    return Path(path).open("rb")


def read_bounded(stream: IO[bytes], most_bytes: int) -> bytes:
    """Return the first `most_bytes` + 1 bytes of a stream, or all if there are fewer.

    A longer result than `most_bytes` means that the content is too large. Reading takes the memory of the result and a
    megabyte. Raises `TypeError` for a stream of text.
    """
    content, bytes_left = io.BytesIO(), most_bytes + 1
    # A single `stream.read(n)` would allocate the n allowed bytes even for a small file.
    while bytes_left > 0 and (block := stream.read(min(bytes_left, _BLOCK_BYTES))):
        bytes_left -= content.write(block)
    return content.getvalue()


def read_regular(path: str | Path, largest_bytes: int) -> bytes:
    """Return the content of a regular file; raises `OSError` as `check_regular` does, or for a larger file."""
    with open_regular(path) as stream:
        data = read_bounded(stream, largest_bytes)
    if len(data) > largest_bytes:
        reason = f"it is larger than {largest_bytes / 1e6:g} MB, the largest size that is read"
        raise OSError(errno.EFBIG, reason, str(path))
    return data
