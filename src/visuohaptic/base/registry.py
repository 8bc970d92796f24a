"""Registries: named variants of one kind, such as probing strategies or classifiers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, Generic, Protocol, TypeVar

from pydantic_core import CoreSchema, PydanticKnownError, core_schema

from visuohaptic.base.errors import RegistryError


class Named(Protocol):
    """An entry of a registry."""

    @property
    def name(self) -> str:
        """Name in parameters and tables."""


Entry = TypeVar("Entry", bound=Named)


class Registry(Generic[Entry]):
    """Entries of one kind by name, in order.

    As metadata of a string, ``Annotated[str, STRATEGIES]``, a registry makes pydantic allow only registered names,
    also names that are added later.

    Parameters
    ----------
    kind : str
        The kind in error messages, such as ``probing strategy``.
    *entries : Named
        The first entries, in order.
    extends : Registry, optional
        Its entries come before those of the new registry. Both share one set of names, also for entries that are
        added later.

    Raises
    ------
    RegistryError
        If a name occurs twice, or has other characters than ``a`` to ``z`` and ``_``. Names become parts of file names.
    """

    def __init__(self, kind: str, *entries: Entry, extends: Registry[Any] | None = None) -> None:
        self.kind = kind
        self._extends = extends
        self._sharing: list[Registry[Any]] = [] if extends is None else extends._sharing
        self._sharing.append(self)
        self._entries: dict[str, Entry] = {}
        self._sources: dict[str, str] = {}
        for entry in entries:
            self._check_name(entry.name)
            self._entries[entry.name] = entry

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all entries, in order."""
        return tuple(self._by_name)

    @property
    def _by_name(self) -> dict[str, Entry]:
        """All entries, of this registry and of the registry that it extends."""
        if self._extends is None:
            return self._entries
        return {**self._extends._by_name, **self._entries}

    def add(self, entry: Entry, source: str, before: str | None = None) -> None:
        """Add an entry of a plug-in: before the entry named `before`, or else as the last entry.

        `source` names the plug-in. Only the same source may replace an entry of the same name.
        Raises `RegistryError` if another entry has the name, or the name has other characters than a to z and _.
        """
        if self._sources.get(entry.name) != source:
            self._check_name(entry.name)
        following = self[before].name if before is not None else None
        self._entries.pop(entry.name, None)
        self._sources[entry.name] = source
        entries = list(self._entries.values())
        index = next(
            (position for position, other in enumerate(entries) if other.name == following),
            len(entries),
        )
        entries.insert(index, entry)
        # Keep the dict object: callers may hold a view of it.
        self._entries.clear()
        self._entries.update((other.name, other) for other in entries)

    def __getitem__(self, name: str) -> Entry:
        if name not in self._by_name:
            raise RegistryError(f"{name!r} is no {self.kind}; {', '.join(self.names)} are allowed.")
        return self._by_name[name]

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._by_name.values())

    def _check_name(self, name: str) -> None:
        is_taken = any(name in registry._entries for registry in self._sharing)
        if not re.fullmatch("[a-z_]+", name) or is_taken:
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
