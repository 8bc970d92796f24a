"""Packages that only some commands need: each is in an extra of this package."""

from __future__ import annotations

import sys
from importlib.util import find_spec

from visuohaptic.base.errors import MissingPackageError


def require(extra: str, *packages: str) -> None:
    """Refuse, before any work, what needs packages of an extra that are not installed: `MissingPackageError`."""
    if sentence := what_is_missing(extra, *packages):
        raise MissingPackageError(sentence)


def what_is_missing(extra: str, *packages: str) -> str | None:
    """Give the sentence that names the packages that are not installed; None where all are."""
    missing = [name for name in packages if find_spec(name) is None]
    if not missing:
        return None
    verb = "is" if len(missing) == 1 else "are"
    named = " and ".join(filter(None, [", ".join(missing[:-1]), missing[-1]]))
    return (
        f"{named} {verb} not installed; "
        f"`pip install 'visuohaptic[{extra}]'` brings {'it' if verb == 'is' else 'them'}."
    )


def keep_pandas_out() -> None:
    """Keep pyarrow from importing pandas with its first array, which takes 0.2 s of a process; it can still do so later."""
    if "pandas" in sys.modules:
        return
    import pyarrow as pa

    deny_pandas()
    try:
        pa.array([0])
    finally:
        allow_pandas()


def deny_pandas() -> None:
    """Let imports of pandas fail, as if it were not installed, until `allow_pandas`."""
    sys.meta_path.insert(0, _NoPandas)


def allow_pandas() -> None:
    """Let imports of pandas succeed again."""
    sys.meta_path[:] = [finder for finder in sys.meta_path if finder is not _NoPandas]


class _NoPandas:
    """A finder for `sys.meta_path` that denies pandas."""

    @staticmethod
    def find_spec(name: str, *_: object) -> None:
        if name == "pandas":
            raise ModuleNotFoundError(name=name)
