"""Packages that only some commands need; each belongs to an extra of this package."""

from __future__ import annotations

import sys
from importlib.util import find_spec

from visuohaptic.base.errors import MissingPackageError


def require(extra: str, *packages: str) -> None:
    """Raise `MissingPackageError` if any of `packages`, which `extra` installs, is missing."""
    if sentence := missing_packages(extra, *packages):
        raise MissingPackageError(sentence)


def missing_packages(extra: str, *packages: str) -> str | None:
    """Return a sentence that names the missing packages and the extra that installs them; None if all are installed."""
    missing = [name for name in packages if find_spec(name) is None]
    if not missing:
        return None
    verb = "is" if len(missing) == 1 else "are"
    names = " and ".join(filter(None, [", ".join(missing[:-1]), missing[-1]]))
    return (
        f"{names} {verb} not installed; "
        f"`pip install 'visuohaptic[{extra}]'` brings {'it' if verb == 'is' else 'them'}."
    )


def keep_pandas_out() -> None:
    """Make the first array of pyarrow without importing pandas, which saves 0.2 s per process.

    Later imports of pandas work as usual.
    """
    if "pandas" in sys.modules:
        return
    import pyarrow as pa

    sys.meta_path.insert(0, _NoPandas)
    try:
        pa.array([0])
    finally:
        sys.meta_path.remove(_NoPandas)


class _NoPandas:
    """A finder for `sys.meta_path` that raises `ModuleNotFoundError` for pandas."""

    @staticmethod
    def find_spec(name: str, *_: object) -> None:
        if name == "pandas":
            raise ModuleNotFoundError(name=name)
