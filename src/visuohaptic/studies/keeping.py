"""Keep the measured result of a study beside the study: `python -m visuohaptic.studies.keeping STUDY SET [FILE]`.

The kept file is ``kept_<set>.parquet``, or ``kept_<set>.json`` for figures, in the folder of the study. `FILE` is the
measured result; by default the command keeps `Study.kept`.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from visuohaptic.base.atomic_files import atomic_file, atomic_write_text
from visuohaptic.base.errors import ReportError, TableError
from visuohaptic.io.checkout import find_commit
from visuohaptic.studies.registry import REPOSITORY, load_study
from visuohaptic.tables.schema import Schema, open_parquet, read_table

_KEPT = "kept_{}"


@dataclass(frozen=True)
class Source:
    """Source of a kept table: set of objects, commit of the code, and day of the measurement (UTC)."""

    set: str
    commit: str
    date: str


def write_measured(table: pa.Table, name: str, path: str | Path, failed: str = "") -> None:
    """Write a measured table with the name of its set of objects in its metadata, whole or not at all.

    `failed` names a condition that the table lacks, and the reason; such a table is not kept.
    """
    _write(table, {"set": name} | ({"failed": failed} if failed else {}), path)


def keep(measured: str | Path, name: str, folder: str | Path) -> None:
    """Copy a measured table, or figures in a JSON file, to the kept file of a set, with the present commit and date.

    Raises
    ------
    ReportError
        If the table was measured on another set, or lacks a condition that could not be measured.
    TableError
        If the file is missing or no Parquet file.
    """
    source = Source(name, find_commit(), datetime.now(UTC).strftime("%Y-%m-%d"))
    suffix = Path(measured).suffix
    if suffix == ".json":
        figures = json.loads(Path(measured).read_text(encoding="utf-8"))
        text = json.dumps({**asdict(source), "figures": figures}, indent=1, ensure_ascii=False)
        atomic_write_text(kept_file(folder, name, suffix), f"{text}\n")
        return
    table = open_parquet(measured).read()
    metadata = _metadata(table.schema)
    found = metadata.get("set", name)
    if found != name:
        raise ReportError(f"{measured} has set {found}; set {name} is needed.")
    if "failed" in metadata:
        raise ReportError(
            f"{measured} lacks a condition that could not be measured, {metadata['failed']}"
        )
    _write(table, asdict(source), kept_file(folder, name))


def kept_file(folder: str | Path, name: str, suffix: str = ".parquet") -> Path:
    """Return the path of the kept table of a set, or of kept figures with suffix ``.json``."""
    return Path(folder, _KEPT.format(name) + suffix)


def kept_files(folder: str | Path) -> dict[str, Path]:
    """Find the kept tables in a folder, by set in the order of their names."""
    paths = sorted(Path(folder).glob(_KEPT.format("*.parquet")))
    return {path.stem.removeprefix(_KEPT.format("")): path for path in paths}


def read_figures(folder: str | Path, name: str) -> tuple[Any, Source]:
    """Read the kept figures of a set, and their source."""
    kept = json.loads(kept_file(folder, name, ".json").read_text(encoding="utf-8"))
    return kept.pop("figures"), Source(**kept)


def read_result(schema: Schema, path: str | Path, study: str) -> pa.Table:
    """Read a kept table, or the table that a run of a study wrote. Raises `ReportError` if the file is damaged."""
    try:
        return read_table(schema, path)
    except TableError as error:
        raise ReportError(
            f"{path} holds no result of study {study} ({error}); run `make {study}` again."
        ) from error


def read_source(path: str | Path) -> Source:
    """Read the source of a kept table.

    Raises `ReportError` if the table has none, and `TableError` if the file is missing or no Parquet file.
    """
    metadata = _metadata(open_parquet(path).schema_arrow)
    missing = [name for name in Source.__dataclass_fields__ if name not in metadata]
    if missing:
        raise ReportError(
            f"{path} does not name its {missing[0]}; `git checkout {path}` restores the kept table."
        )
    return Source(*(metadata[name] for name in Source.__dataclass_fields__))


def _metadata(schema: pa.Schema) -> dict[str, str]:
    return {key.decode(): value.decode() for key, value in (schema.metadata or {}).items()}


def _write(table: pa.Table, named: dict[str, str], path: str | Path) -> None:
    """Write a table with further entries in its metadata."""
    metadata = {**_metadata(table.schema), **named}
    with atomic_file(path) as unfinished:
        pq.write_table(table.replace_schema_metadata(metadata), unfinished, compression="zstd")


def keep_study(study: str, name: str, measured: str | Path | None = None) -> None:
    """Keep the result of a study of the repository; by default `Study.kept`, relative to the working folder.

    Raises `ReportError` if the study names no result and `measured` is None; further errors as in `keep`.
    """
    folder = REPOSITORY / study
    if measured is None:
        measured = load_study(folder / "study.py", study).kept
        if not measured:
            raise ReportError(
                f"Study {study} has no field `kept`; name the measured file after the set."
            )
    keep(measured, name, folder)


if __name__ == "__main__":
    keep_study(*sys.argv[1:])
