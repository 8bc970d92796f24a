"""Variants by their names: one entry holds all that there is to know of each."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from visuohaptic.errors import RegistryError

if TYPE_CHECKING:
    from pydantic_core import CoreSchema


class Named(Protocol):
    """An entry of a registry."""

    @property
    def name(self) -> str:
        """What parameters and tables call it."""


Entry = TypeVar("Entry", bound=Named)


class Registry(Generic[Entry]):
    """All variants of one kind, in order.

    As metadata of a string, as in ``Annotated[str, STRATEGIES]``, it makes pydantic allow the
    registered names alone.

    Parameters
    ----------
    kind : str
        What an entry is, such as ``probing strategy``; errors name it.
    *entries : object
        The variants.

    Raises
    ------
    RegistryError
        If two entries have one name, or a name is not made of ``a`` to ``z`` and ``_``, as it
        becomes a part of file names.
    """

    def __init__(self, kind: str, *entries: Entry) -> None:
        self.kind = kind
        self.names = tuple(entry.name for entry in entries)
        self._entries = {entry.name: entry for entry in entries}
        for name in self.names:
            if not re.fullmatch("[a-z_]+", name) or self.names.count(name) > 1:
                raise RegistryError(
                    f"{name!r} can't name a {kind}; letters a to z and _ are allowed, and each "
                    "name once."
                )

    def __getitem__(self, name: str) -> Entry:
        if name not in self._entries:
            raise RegistryError(f"{name!r} is no {self.kind}; {', '.join(self.names)} are allowed.")
        return self._entries[name]

    def check_complete(self, declared: Iterable[str], where: str) -> None:
        """Compare the entries with names that are declared elsewhere, in order.

        Raises `RegistryError` if a name is missing on either side, or stands at another place.
        """
        wanted = tuple(declared)
        if wanted != self.names:
            odd = sorted(set(wanted) ^ set(self.names)) or ["the order"]
            raise RegistryError(
                f"The {self.kind} entries and {where} differ in {', '.join(odd)}; the same names "
                "in the same order are needed."
            )

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._entries.values())

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.literal_schema(list(self.names))
