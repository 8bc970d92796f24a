"""Write docs/tables.md from the schemas that every table is checked against: `make readme`."""

from __future__ import annotations

from textwrap import fill

import pyarrow as pa
from filling import DOCS, table

from visuohaptic.pipeline import PHASES
from visuohaptic.tables.schema import Column, Schema
from visuohaptic.tables.schemas import SCHEMAS

PAGE = DOCS / "tables.md"
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
    makers = [f"`{phase.name}`" for phase in PHASES if schema.name in phase.writes]
    written = f" Written by phase {' and '.join(makers)}." if makers else ""
    columns = table(("column", "type", "unit, range", "meaning"), map(_row, schema.columns))
    row = fill(f"One row for each {keys}.{written}", 100)
    return f"## {schema.name}\n\n{row}\n\n{columns}\n".replace("|  |", "| |")


def _row(column: Column) -> list[str]:
    missing = ", may be missing" if column.nullable else ""
    kind = "text" if pa.types.is_dictionary(column.dtype) else str(column.dtype)
    kind = {"string": "text", "large_string": "text", "binary": "bytes"}.get(kind, kind)
    return [f"`{column.name}`", f"{kind}{missing}", _range(column), column.description]


def _range(column: Column) -> str:
    ends = [column.minimum, column.maximum]
    low, high = ("…" if end is None else f"{end:g}" for end in ends)
    limits = "" if ends == [None, None] else f"{low} to {high}"
    return ", ".join(filter(None, (column.unit, limits)))


if __name__ == "__main__":
    PAGE.write_text(tables_page(), encoding="utf-8")
