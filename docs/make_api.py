"""Write docs/api.md from the docstrings of the public names: `make readme`."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from functools import cached_property
from textwrap import fill
from typing import Any

from filling import DOCS, table

import visuohaptic as vh

PAGE = DOCS / "api.md"
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
    # Functions, then classes, each in the order of the alphabet.
    names = sorted(vh.__all__, key=lambda name: (inspect.isclass(getattr(vh, name)), name.lower()))
    return "\n\n".join([HEAD.rstrip(), *(_entry(name, getattr(vh, name)) for name in names)]) + "\n"


def _entry(name: str, found: Any) -> str:
    docstring = inspect.getdoc(found) or ""
    parts = [f"## {name}", f"`{_call(name, found)}`", _first_sentence(docstring)]
    if rows := [_row(*field) for field in _fields(docstring)]:
        parts.append(table(("name", "type", "meaning"), rows))
    if methods := [_method(*named) for named in _methods(found)]:
        parts.append("\n".join(methods))
    return "\n\n".join(parts)


def _call(name: str, found: Callable[..., Any]) -> str:
    if inspect.isclass(found) and issubclass(found, Exception):
        return name
    taken = inspect.signature(found).parameters.values()
    parts = [_argument(one) for one in taken]
    kinds = [one.kind for one in taken]
    if inspect.Parameter.KEYWORD_ONLY in kinds and inspect.Parameter.VAR_POSITIONAL not in kinds:
        parts.insert(kinds.index(inspect.Parameter.KEYWORD_ONLY), "*")
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


def _row(names: str, kind: str, meaning: str) -> list[str]:
    cells = (f"`{names}`", _markdown(kind), _first_sentence(meaning))
    return [cell.replace("|", "\\|") for cell in cells]


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
