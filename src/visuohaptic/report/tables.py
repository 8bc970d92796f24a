"""The tables of the page: rows, columns and their formats."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from jinja2 import Environment, pass_environment
from markupsafe import Markup

from visuohaptic.evaluation.intervals import Interval
from visuohaptic.report.estimates import (
    Figure,
    above_interval,
    estimate,
    figure_of,
    points_above_interval,
    share_above_interval,
)
from visuohaptic.report.wording import strategy_name, titled

Column = Sequence[str]
"""Heading, key and format; without a format the value is shown unchanged."""

SHARES = {"percent": share_above_interval, "points": points_above_interval}
"""Formats of shares and of their differences."""

NUMBER = "number"
"""The format of a text that is aligned as a number."""

NONE = "\N{EN DASH}"
"""The text of a cell without a value."""


def each(keys: Iterable[str], heading: str, key: str, form: str = "") -> list[Column]:
    """Return one column per strategy.

    ``{}`` in `heading` becomes the strategy's name in words, ``{}`` in `key` its key; `form` is the format.
    """
    return [
        (titled(heading.format(strategy_name(strategy))), key.format(strategy), form)
        for strategy in keys
    ]


@pass_environment
def table(
    environment: Environment,
    rows: Iterable[Any],
    label: str,
    columns: Sequence[Column],
    caption: str = "",
    best: object = None,
) -> Markup:
    """Render rows as an HTML table that scrolls on a narrow screen.

    Parameters
    ----------
    environment : jinja2.Environment
        The environment of the page; Jinja passes it.
    rows : iterable of mappings or objects
        A row with a value ``mark`` has that CSS class.
    label : str
        The name of the table for screen readers; unique on the page.
    columns : sequence of (heading, key, format)
        The first column has the headings of the rows; columns of numbers are aligned to the right.
        A key is the name of a value, or several names joined by dots (``accuracy.fixation``); an empty key is the row
        itself. A format is the name of a filter, several names joined by ``|``, a ``%`` format, or a text for
        `str.format`. After ``±`` the name of a filter also formats the value's interval.
    caption : str
        The text above the table; by default the label.
    best : object
        The row of `rows` that is shown in bold.
    """
    listed = list(rows)
    cells = [
        (
            "best" if row is best else isinstance(row, Mapping) and row.get("mark"),
            [_write(environment, row, *column[1:]) for column in columns],
        )
        for row in listed
    ]
    numeric = [
        column[-1] == NUMBER or any(_is_number(_find(row, column[1])) for row in listed)
        for column in columns
    ]
    return Markup(  # noqa: S704 - the template escapes
        environment.get_template("table.html.jinja").render(
            label=label,
            caption=caption or label,
            headings=[column[0] for column in columns],
            numeric=numeric,
            rows=cells,
        )
    )


def _is_number(value: object) -> bool:
    kinds = (int, float, Figure, Interval, Mapping)
    return isinstance(value, kinds) and not isinstance(value, bool)


def _find(row: Any, key: str) -> Any:
    """Return the value of a key in a row; None if a value on the way is missing."""
    for name in filter(None, key.split(".")):
        if isinstance(row, tuple):
            row = row[int(name)]
        elif row is not None:
            row = row.get(name) if isinstance(row, Mapping) else getattr(row, name)
    return row


def _write(environment: Environment, row: Any, key: str, form: str = "") -> object:
    value = _find(row, key)
    if value is None:
        return NONE
    if form.startswith("±"):
        owner, _, name = key.rpartition(".")
        figure = estimate(value) if isinstance(value, Interval) else value
        if not isinstance(figure, Figure):
            figure = figure_of(_find(row, owner), name) or Figure(value)
        write = SHARES.get(form[1:])
        return write(figure) if write else above_interval(figure, environment.filters[form[1:]])
    if "%" in form:
        return form % value
    if "{" in form:
        return form.format(value)
    for name in filter(None, form.split("|")):
        value = environment.filters[name](value)
    return value
