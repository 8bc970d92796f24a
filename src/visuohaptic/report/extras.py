"""Sections of phases that not every run has: each appears where its table lies, and only there.

Such a table is a Parquet file (or a folder of them) whose columns carry a description
and a unit, as `tables.Schema` writes them, or a JSON file that holds a list of flat records.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from visuohaptic.errors import ReportError
from visuohaptic.report.wording import spaced

MOST_ROWS = 200


@dataclass(frozen=True)
class Extra:
    """A section that is shown if its table exists: name, title, place and first sentence."""

    name: str
    title: str
    after: str
    introduction: str


EXTRAS = (
    Extra(
        "resolution",
        "What a sharper view costs",
        "cost",
        "Fixations at each resolution of the view beside those at the largest one: median distance "
        "in object radii, share within one focus, and milliseconds a view, as `make bench` "
        "measured them.",
    ),
)


@dataclass(frozen=True)
class ExtraTable:
    """A table to be shown as it is: titles with descriptions, and cells as texts."""

    extra: Extra
    columns: tuple[tuple[str, str], ...]
    rows: tuple[tuple[str, ...], ...]
    left_out: int


def read_extra(extra: Extra, path: Path) -> ExtraTable | None:
    """Read the table of a section.

    Parameters
    ----------
    extra : Extra
        The section.
    path : path
        A JSON file, a Parquet file, or a folder of Parquet files.

    Returns
    -------
    ExtraTable or None
        None where there is no such file.

    Raises
    ------
    ReportError
        If the file is there but holds no table.
    """
    if not path.exists():
        return None
    if path.suffix == ".json":
        columns, records = _read_json(path)
    else:
        columns, records = _read_parquet(path)
    rows = tuple(
        tuple(_cell(record.get(name)) for name, _ in columns) for record in records[:MOST_ROWS]
    )
    titles = tuple((spaced(name), description) for name, description in columns)
    return ExtraTable(extra, titles, rows, max(0, len(records) - MOST_ROWS))


def _read_json(path: Path) -> tuple[list[tuple[str, str]], list[dict[str, object]]]:
    try:
        records = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ReportError(f"{path} is no JSON ({error}); make it again.") from error
    if not isinstance(records, list) or not all(isinstance(record, dict) for record in records):
        raise ReportError(f"{path} holds no list of records; one flat record a row is allowed.")
    names = list(dict.fromkeys(name for record in records for name in record))
    return [(name, "") for name in names], records


def _read_parquet(path: Path) -> tuple[list[tuple[str, str]], list[dict[str, object]]]:
    import pyarrow.parquet as pq

    table = pq.read_table(path)
    return [
        (field.name, _description(field.metadata or {})) for field in table.schema
    ], table.to_pylist()


def _description(metadata: dict[bytes, bytes]) -> str:
    texts = [metadata.get(key, b"").decode("utf-8") for key in (b"description", b"unit")]
    return ", ".join(filter(None, texts))


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
