"""`visuohaptic tables`: list the columns of a table from its schema."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from visuohaptic.cli.printing import say

if TYPE_CHECKING:
    from visuohaptic.tables.schema import Column

TYPES = {"string": "text", "binary": "bytes"}


def tables(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Name of a table.", show_default=False)
    ] = "",
) -> None:
    """List all tables, or the columns of a table: type, unit, closed range of the values, and meaning.

    A table is a Parquet file or a folder of Parquet files. Metadata of each field has its unit and meaning.
    Lengths are in object radii: the bounding sphere has its centre in the origin and radius 1, and y points up.

    Example: visuohaptic tables touches
    """
    from visuohaptic.phases import PHASES
    from visuohaptic.tables.schemas import SCHEMAS

    if not name:
        _say_rows(
            [(table.name, f"one row per {', '.join(table.keys)}") for table in SCHEMAS.values()]
        )
        return
    if name not in SCHEMAS:
        raise typer.BadParameter(f"there is no table {name!r}; {', '.join(SCHEMAS)} are allowed.")
    schema = SCHEMAS[name]
    makers = [phase.name for phase in PHASES if name in phase.writes]
    phase_note = f"; written by phase {' and '.join(makers)}" if makers else ""
    say(f"{name}: one row per {', '.join(schema.keys)}{phase_note}")
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
