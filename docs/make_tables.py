"""Write docs/tables.md from the schemas that every table is checked against: `make readme`."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill

import pyarrow as pa

from visuohaptic.pipeline import PHASES
from visuohaptic.tables.schema import Column, Schema
from visuohaptic.tables.schemas import SCHEMAS

PAGE = Path(__file__).with_name("tables.md")
INTRODUCTION = """\
# Tables

Every table is Parquet: one file, or a folder of files that reads as one. It is checked against its
schema before it is written, and written whole or not at all; a column's description and unit lie in
the file as metadata of its field. A pair of numbers after a unit is the closed range of every
value. Lengths are in object radii: the bounding sphere's centre is the origin, its radius 1, and y
points up.

```python
import pyarrow.parquet

table = pyarrow.parquet.read_table("results/touches")
print(table.schema.field("sensor_size").metadata)
```

This page is made from `src/visuohaptic/tables/` by `python docs/make_tables.py`; a test compares
the two.
"""


def tables_page() -> str:
    """Give the page, in Markdown."""
    return "\n".join([INTRODUCTION, *(_section(schema) for schema in SCHEMAS.values())])


def _section(schema: Schema) -> str:
    keys = ", ".join(f"`{key}`" for key in schema.keys)
    return "\n".join(
        [
            f"## {schema.name}",
            "",
            fill(f"One row for each {keys}.{_makers(schema.name)}", 100),
            "",
            "| column | type | unit, range | meaning |",
            "|---|---|---|---|",
            *(_row(column) for column in schema.columns),
            "",
        ]
    )


def _makers(table: str) -> str:
    names = [f"`{phase.name}`" for phase in PHASES if table in phase.writes]
    return f" Written by phase {' and '.join(names)}." if names else ""


def _row(column: Column) -> str:
    kind = f"{_kind(column.dtype)}{', may be missing' if column.nullable else ''}"
    return f"| `{column.name}` | {kind} | {_range(column)} | {column.description} |".replace(
        "|  |", "| |"
    )


def _kind(dtype: pa.DataType) -> str:
    if pa.types.is_dictionary(dtype):
        return "text"
    return {"string": "text", "large_string": "text", "binary": "bytes"}.get(
        str(dtype), str(dtype)
    ).replace("|", "\\|")


def _range(column: Column) -> str:
    ends = [column.minimum, column.maximum]
    low, high = ("…" if end is None else f"{end:g}" for end in ends)
    limits = "" if ends == [None, None] else f"{low} to {high}"
    return ", ".join(filter(None, (column.unit, limits)))


if __name__ == "__main__":
    PAGE.write_text(tables_page(), encoding="utf-8")
