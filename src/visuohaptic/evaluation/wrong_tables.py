"""Name the table that a caller gave in place of the table that an evaluation reads."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.base.errors import RecognitionError, TableError
from visuohaptic.tables.schema import names_of, open_parquet
from visuohaptic.tables.schemas import SCHEMAS

_UNKNOWN = "unknown"
"""Class of objects that were loaded without a key."""


def why_no_table(given: object, needed: str) -> str | None:
    """Return the sentence that says what `given` is and what `evaluate` reads; None if this is not known.

    `needed` is the name of the table: ``features`` or ``touches``.
    """
    if isinstance(given, list | tuple) and given and all(map(_is_table_or_exploration, given)):
        return (
            f"This is a {type(given).__name__}; evaluate reads one table: join the tables of several objects by "
            f"pyarrow.concat_tables, such as the {needed} of each exploration."
        )
    if _is_exploration(given):
        return (
            f"This is an Exploration; evaluate reads its table {needed}: pass exploration.{needed}."
        )
    name = name_of_table(_column_names(given))
    if name is None or name == needed:
        return None
    others = {
        "features": "results/features, or the table touches with inputs='touches'",
        "touches": "results/touches with inputs='touches'",
    }
    return f"This is table {name}; evaluate reads {others[needed]}."


def check_classes_are_named(table: pa.Table) -> None:
    """Raise `RecognitionError` if all rows are of class ``unknown``, which `visuohaptic.load` gives without a key."""
    if table.column("class").unique().to_pylist() == [_UNKNOWN]:
        raise RecognitionError(
            f"All objects are of class {_UNKNOWN}; name the class of each by vh.load(file, key='class/name')."
        )


def name_of_table(columns: Iterable[str]) -> str | None:
    """Return the name of the table that has these columns, and perhaps others; None for no table of this package."""
    names = set(columns)
    fitting = [schema for schema in SCHEMAS.values() if names.issuperset(names_of(schema.columns))]
    return max(fitting, key=lambda schema: len(schema.columns)).name if fitting else None


def _is_exploration(given: object) -> bool:
    return all(hasattr(given, name) for name in ("features", "touches", "poses"))


def _is_table_or_exploration(given: object) -> bool:
    return _is_exploration(given) or isinstance(given, pa.Table) or hasattr(given, "columns")


def _column_names(given: Any) -> list[str]:
    """Return the names of the columns of a table, a data frame, a mapping, or the first file of a path."""
    if isinstance(given, str | Path):
        path = Path(given)
        files = sorted(path.rglob("*.parquet")) if path.is_dir() else [path]
        try:
            return list(open_parquet(files[0]).schema_arrow.names) if files else []
        except TableError:
            return []
    if isinstance(given, Mapping):
        return list(given)
    names = getattr(given, "column_names", getattr(given, "columns", ()))
    return [name for name in names if isinstance(name, str)]
