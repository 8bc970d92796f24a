"""Packages that only some commands need; each belongs to an extra of this package."""

from __future__ import annotations

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
