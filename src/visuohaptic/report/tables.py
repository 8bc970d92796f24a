"""The tables of the page: of some rows, these columns with these formats."""

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
"""Heading, key and format; without a format the value is written as it is."""

SHARES = {"percent": share_above_interval, "points": points_above_interval}
"""Formats of shares and of their differences."""

NUMBER = "number"
"""The format of a text that stands where numbers do."""

NONE = "\N{EN DASH}"
"""Stands where there is no value."""


def each(keys: Iterable[str], heading: str, key: str, form: str = "") -> list[Column]:
    """Give a column for each strategy, with its name and its key in the places of ``{}``."""
    return [(titled(heading.format(strategy_name(one))), key.format(one), form) for one in keys]


@pass_environment
def table(
    environment: Environment,
    rows: Iterable[Any],
    label: str,
    columns: Sequence[Column],
    caption: str = "",
    best: object = None,
) -> Markup:
    """Write rows as a table that scrolls where the screen is narrow.

    The first column heads its row; a row with ``mark`` has that class, and the row `best` stands out. The
    key of a column is a name, or several joined by points; without one it is the whole row. A format is
    the name of a filter, of several joined by ``|``, or as for ``%`` and `format`; after ``±`` it writes
    the interval, too. A column of numbers stands to the right. `label` is what the table is called, once
    on the page; `caption` stands above it, if not the label.
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
    """Follow a key; None where it leads nowhere."""
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
