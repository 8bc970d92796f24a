"""Functions by their names: what is not called is not imported, and is no part of a job's key."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any, get_type_hints


@dataclass(frozen=True)
class Function:
    """A function of a module, which is imported when it is first called.

    Its name is ``module:function``, written out: keys find in the source which code stands behind it.
    """

    name: str

    @property
    def module(self) -> str:
        """The module's name."""
        return self.name.partition(":")[0]

    def load(self) -> Callable[..., Any]:
        """Import it."""
        return getattr(import_module(self.module), self.name.partition(":")[2])

    def __call__(self, *values: Any, **arguments: Any) -> Any:
        """Call it."""
        return self.load()(*values, **arguments)

    def checked(self, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """Turn arguments of built-in types into what the function's annotations say."""
        checks = _checks(self)
        return {name: checks(name).validate_python(value) for name, value in arguments.items()}


@cache
def _checks(function: Function) -> Callable[[str], Any]:
    from pydantic import TypeAdapter

    hints = get_type_hints(function.load())
    return cache(lambda name: TypeAdapter(hints[name]))
