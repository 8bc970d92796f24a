"""The tables of the page: rows, and columns with a function that writes their cells."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeAlias

from jinja2 import Environment, pass_environment
from markupsafe import Markup

from visuohaptic.evaluation.intervals import Interval
from visuohaptic.report.cells import NONE, number, titled_strategy
from visuohaptic.report.estimates import Estimate

Cell: TypeAlias = Callable[[Any], object]
"""Writes a value as a cell; the functions of `cells`."""

Column: TypeAlias = tuple[str, str] | tuple[str, str, Cell]
"""Heading, name of the value in a row, and the function that writes the value; without it the value is unchanged."""


def unchanged(value: object) -> object:
    """Return the value of a cell that needs no writing."""
    return value


def by_strategy(strategies: Iterable[str], values: str, cell: Cell = unchanged) -> list[Column]:
    """Return one column per strategy; rows have a mapping `values` of strategies to values."""
    return [(titled_strategy(key), f"{values}.{key}", cell) for key in strategies]


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
    columns : sequence of Column
        The first column has the headings of the rows; columns of numbers, and of `cells.number`, are aligned to the
        right. Dots lead to values within values, as in ``accuracy.fixation``. A value None is written as a dash.
    caption : str
        The text above the table; by default the label.
    best : object
        The row of `rows` that is shown in bold.
    """
    listed = list(rows)
    values = [[_find(row, name) for _, name, *_ in columns] for row in listed]
    numeric = [
        number in column or any(_is_number(in_row[index]) for in_row in values)
        for index, column in enumerate(columns)
    ]
    cells = [
        (
            "best" if row is best else isinstance(row, Mapping) and row.get("mark"),
            [_write(value, *column[2:]) for value, column in zip(in_row, columns, strict=True)],
        )
        for row, in_row in zip(listed, values, strict=True)
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
    kinds = (int, float, Estimate, Interval, Mapping)
    return isinstance(value, kinds) and not isinstance(value, bool)


def _find(row: Any, name: str) -> Any:
    """Return the value of a dotted name in a row; None if a value on the way is missing."""
    for part in name.split("."):
        if isinstance(row, tuple):
            row = row[int(part)]
        elif row is not None:
            row = row.get(part) if isinstance(row, Mapping) else getattr(row, part)
    return row


def _write(value: object, cell: Cell = unchanged) -> object:
    return NONE if value is None else cell(value)
