"""Packages that only some commands need: each is in an extra of this package."""

from __future__ import annotations

from importlib.util import find_spec

from visuohaptic.errors import MissingPackageError


def require(extra: str, *packages: str) -> None:
    """Refuse, before any work, what needs packages that are not installed.

    `extra` of this package brings them, such as ``report``. Raises `MissingPackageError`.
    """
    missing = [name for name in packages if find_spec(name) is None]
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        raise MissingPackageError(
            f"{' and '.join(missing)} {verb} not installed; "
            f"`pip install 'visuohaptic[{extra}]'` brings {'it' if verb == 'is' else 'them'}."
        )
