"""Say in one clause which value or name is allowed in place of a refused value or an unknown parameter."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import Any

SIMILAR = 0.7
"""Least similarity of a name that is suggested in place of a misspelt one (ratio of `difflib`)."""

_NEEDED = {
    "bool_parsing": "true or false is needed",
    "bool_type": "true or false is needed",
    "dict_type": "a section with names is needed",
    "finite_number": "a finite number is needed",
    "float_parsing": "a number is needed",
    "float_type": "a number is needed",
    "greater_than": "a number above {gt} is needed",
    "greater_than_equal": "a number of at least {ge} is needed",
    "int_from_float": "a whole number is needed",
    "int_parsing": "a whole number is needed",
    "int_type": "a whole number is needed",
    "less_than": "a number below {lt} is needed",
    "less_than_equal": "a number of at most {le} is needed",
    "list_type": "a list is needed",
    "model_type": "a section with names is needed",
    "string_type": "text is needed",
    "too_long": "at most {max_length} values are needed",
    "too_short": "at least {min_length} value is needed",
    "tuple_type": "a list is needed",
}
"""Clause per type of pydantic's errors, with names of the error's context."""


def needed_value(problem: Mapping[str, Any]) -> str:
    """Return the clause of one of pydantic's errors: the value that is needed, or the most similar allowed name."""
    context = problem.get("ctx", {})
    if problem["type"] == "literal_error":
        names = re.findall(r"'([^']*)'", context["expected"])
        similar = get_close_matches(str(problem["input"]), names, 1, SIMILAR)
        return f"did you mean {similar[0]}?" if similar else f"{', '.join(names)} are allowed"
    if problem["type"] in _NEEDED:
        limits = {
            name: f"{limit:g}" if isinstance(limit, float) else limit
            for name, limit in context.items()
        }
        return _NEEDED[problem["type"]].format(**limits)
    message = str(problem["msg"]).removeprefix("Value error, ").rstrip(".")
    return message[0].lower() + message[1:]


def unknown_parameter(
    name: str, siblings: Iterable[str] = (), elsewhere: Iterable[str] = ()
) -> str:
    """Return the clause that no parameter has this dotted name, with a suggestion.

    The most similar of `siblings`, the names of the same section, is suggested. Without such a name, the dotted names
    `elsewhere` are suggested.
    """
    *section, last = name.split(".")
    similar = get_close_matches(last, siblings, 1, SIMILAR)
    suggested = [".".join([*section, *similar])] if similar else list(elsewhere)
    ending = f"; did you mean {' or '.join(suggested)}?" if suggested else ""
    return f"{name} is no parameter{ending}"
