"""Variants by their names: one entry holds all that there is to know of each."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Generic, Protocol, TypeVar

from pydantic_core import CoreSchema, PydanticKnownError, core_schema

from visuohaptic.base.errors import RegistryError


class Named(Protocol):
    """An entry of a registry."""

    @property
    def name(self) -> str:
        """What parameters and tables call it."""


Entry = TypeVar("Entry", bound=Named)


class Registry(Generic[Entry]):
    """All variants of one kind, in order; errors name the kind, such as ``probing strategy``.

    As metadata of a string, as in ``Annotated[str, STRATEGIES]``, it makes pydantic allow the registered
    names alone, later ones too. Raises `RegistryError` if a name is there twice, or is not made of ``a`` to
    ``z`` and ``_``, as it becomes a part of file names.
    """

    def __init__(self, kind: str, *entries: Entry) -> None:
        self.kind = kind
        self._entries: dict[str, Entry] = {}
        self._sources: dict[str, str] = {}
        for entry in entries:
            self._check_name(entry.name)
            self._entries[entry.name] = entry

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all entries, in order."""
        return tuple(self._entries)

    def add(self, entry: Entry, source: str, before: str | None = None) -> None:
        """Add an entry of a plug-in, the last one or in front of another; its source may replace it.

        Raises `RegistryError` if the name is taken, or can't be one.
        """
        if self._sources.get(entry.name) != source:
            self._check_name(entry.name)
        following = self[before].name if before is not None else None
        self._entries.pop(entry.name, None)
        self._sources[entry.name] = source
        found = list(self._entries.values())
        place = next((at for at, one in enumerate(found) if one.name == following), len(found))
        found.insert(place, entry)
        # In place, for others may hold a view.
        self._entries.clear()
        self._entries.update((one.name, one) for one in found)

    def __getitem__(self, name: str) -> Entry:
        if name not in self._entries:
            raise RegistryError(f"{name!r} is no {self.kind}; {', '.join(self.names)} are allowed.")
        return self._entries[name]

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._entries.values())

    def _check_name(self, name: str) -> None:
        if not re.fullmatch("[a-z_]+", name) or name in self._entries:
            raise RegistryError(
                f"{name!r} can't name a {self.kind}; letters a to z and _ are allowed, and each "
                "name once."
            )

    def _check(self, value: object) -> object:
        if value in self.names:
            return value
        *most, last = map(repr, self.names)
        expected = f"{', '.join(most)} or {last}" if most else last
        raise PydanticKnownError("literal_error", {"expected": expected})

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._check)

    def __get_pydantic_json_schema__(self, *_: object) -> dict[str, object]:
        return {"enum": list(self.names), "type": "string"}
