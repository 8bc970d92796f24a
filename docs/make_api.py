"""Write docs/api.md from the docstrings of the public names: `make readme`."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path
from textwrap import fill
from typing import Any

import visuohaptic as vh

PAGE = Path(__file__).with_name("api.md")
HEAD = """\
# Public names

`import visuohaptic as vh` gives these names; all else may change. `help(vh.press)` shows the whole
docstring, with shapes, units, errors and examples. [tour.md](tour.md) uses them, and
[extending.md](extending.md) those that a plug-in registers.

This page is made from the docstrings by `python docs/make_api.py`; a test compares the two.
"""
_FIELD = re.compile(r"^(?P<names>\w[\w, *]*) : (?P<kind>.+)$")
_LISTED = ("Parameters", "Attributes")
_COMPUTED = (property, cached_property)


def api_page() -> str:
    """Give the page, in Markdown."""
    return (
        "\n\n".join([HEAD.rstrip(), *(_entry(name, getattr(vh, name)) for name in names())]) + "\n"
    )


def names() -> list[str]:
    """Give the public names: functions, then classes, each in the order of the alphabet."""
    return sorted(vh.__all__, key=lambda name: (inspect.isclass(getattr(vh, name)), name.lower()))


def _entry(name: str, found: Any) -> str:
    docstring = inspect.getdoc(found) or ""
    lines = [f"## {name}", "", f"`{_call(name, found)}`", "", _first_sentence(docstring)]
    rows = [_row(*field) for field in _fields(docstring)]
    if rows:
        lines += ["", "| name | type | meaning |", "|---|---|---|", *rows]
    methods = [_method(*named) for named in _methods(found)]
    return "\n".join([*lines, *(["", *methods] if methods else [])])


def _call(name: str, found: Callable[..., Any]) -> str:
    if inspect.isclass(found) and issubclass(found, Exception):
        return name
    taken = inspect.signature(found).parameters.values()
    starred, parts = False, []
    for one in taken:
        if one.kind is one.KEYWORD_ONLY and not starred:
            parts, starred = [*parts, "*"], True
        starred |= one.kind is one.VAR_POSITIONAL
        parts.append(_argument(one))
    return f"{name}({', '.join(parts)})"


def _argument(one: inspect.Parameter) -> str:
    stars = {one.VAR_POSITIONAL: "*", one.VAR_KEYWORD: "**"}.get(one.kind, "")
    if one.default is one.empty:
        return f"{stars}{one.name}"
    plain = isinstance(one.default, str | int | float | bool | tuple | None)
    return f"{one.name}={one.default!r}" if plain else f"{one.name}=…"


def _first_sentence(docstring: str) -> str:
    paragraph = " ".join(docstring.split("\n\n", maxsplit=1)[0].split())
    return _markdown(re.split(r"(?<=[.!?])\s(?=[A-Z`])", paragraph)[0])


def _fields(docstring: str) -> Iterator[tuple[str, str, str]]:
    """Read the names, types and meanings of a docstring's parameters or attributes."""
    for title in _LISTED:
        section = re.search(
            rf"^{title}\n-+\n(.*?)(?=^\w[^\n]*\n-+\n|\Z)", docstring, re.M | re.DOTALL
        )
        held = section[1] if section else ""
        for field in re.finditer(r"^(\S.*)\n((?:[ ]+\S.*\n?|\n(?=[ ]))*)", held, re.M):
            head = _FIELD.match(field[1])
            if head:
                yield head["names"], head["kind"], " ".join(field[2].split())


def _row(names: str, kind: str, meaning: str) -> str:
    cells = (f"`{names}`", _markdown(kind), _first_sentence(meaning))
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def _methods(found: Any) -> Iterator[tuple[str, Any]]:
    """Find a class's own properties and methods; a class method as it is called."""
    for name in vars(found) if inspect.isclass(found) else ():
        one = getattr(found, name)
        if not name.startswith("_") and (isinstance(one, _COMPUTED) or inspect.isroutine(one)):
            yield name, one


def _method(name: str, one: Any) -> str:
    call = name if isinstance(one, _COMPUTED) else _call(name, one)
    # An instance method is written as it is called.
    call = call.replace("(self, ", "(").replace("(self)", "()")
    item = f"- `.{call}`: {_first_sentence(inspect.getdoc(one) or '')}"
    return fill(item, 100, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def _markdown(text: str) -> str:
    return text.replace("``", "`")


if __name__ == "__main__":
    PAGE.write_text(api_page(), encoding="utf-8")
