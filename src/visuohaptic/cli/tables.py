"""`visuohaptic tables`: the columns of a table, from the schema that its files are checked against."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from visuohaptic.cli.printing import say

if TYPE_CHECKING:
    from visuohaptic.tables.schema import Column

TYPES = {"string": "text", "binary": "bytes"}


def tables(
    name: Annotated[str, typer.Argument(metavar="NAME", help="A table.", show_default=False)] = "",
) -> None:
    """List the tables, or the columns of one: type, unit, closed range of the values, and meaning.

    A table is Parquet: one file, or a folder of files that reads as one. Each field's metadata holds
    its unit and meaning. Lengths are in object radii: the bounding sphere's centre is the origin, its
    radius 1, and y points up.

    Example: visuohaptic tables touches
    """
    from visuohaptic.phases import PHASES
    from visuohaptic.tables.schemas import SCHEMAS

    if not name:
        _say_rows([(one.name, f"one row per {', '.join(one.keys)}") for one in SCHEMAS.values()])
        return
    if name not in SCHEMAS:
        raise typer.BadParameter(f"there is no table {name!r}; {', '.join(SCHEMAS)} are allowed.")
    schema = SCHEMAS[name]
    makers = [phase.name for phase in PHASES if name in phase.writes]
    written = f"; written by phase {' and '.join(makers)}" if makers else ""
    say(f"{name}: one row per {', '.join(schema.keys)}{written}")
    _say_rows([describe_column(column) for column in schema.columns])


def describe_column(column: Column) -> tuple[str, ...]:
    """Return the name, type, unit with range, and meaning of a column, as text."""
    kind = TYPES.get(str(column.dtype), str(column.dtype))
    ends = (column.minimum, column.maximum)
    low, high = ("…" if end is None else f"{end:g}" for end in ends)
    limits = "" if ends == (None, None) else f"{low} to {high}"
    unit = ", ".join(filter(None, (column.unit, limits)))
    missing = ", may be missing" if column.nullable else ""
    return column.name, f"{kind}{missing}", unit, column.description


def _say_rows(rows: list[tuple[str, ...]]) -> None:
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    for row in rows:
        say("  ".join(map(str.ljust, row, widths)).rstrip())
