"""Files and rows of a run behind each section of the page."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from visuohaptic.report.objects import ObjectPage
from visuohaptic.report.run import Run
from visuohaptic.report.section import Section, SourceTable
from visuohaptic.tables.schemas import SCHEMAS

Rows = Mapping[str, str | int]
"""Selected rows: a value per column."""


@dataclass(frozen=True)
class Source:
    """Files and rows behind a section; `file` is a path, or a pattern of paths, relative to the run's folder."""

    reads: SourceTable
    file: str
    rows: Rows

    @property
    def is_listed(self) -> bool:
        """Whether `visuohaptic tables` lists the columns; tables of studies describe their columns in the file."""
        return self.reads.schema.name in SCHEMAS

    @property
    def filter(self) -> str:
        """The selected rows in words, such as ``classifier = naive_bayes``; empty for all rows."""
        return ", ".join(f"{column} = {value}" for column, value in self.rows.items())


def find_sources(section: Section, run: Run, page: ObjectPage) -> Iterator[Source]:
    """Yield the files and rows that a section reads of a run; files that are missing are left out.

    `page` is the object that explains the method.
    """
    for table in section.reads(run) if callable(section.reads) else section.reads:
        files = run.parts(table.files)
        for rows in _rows(run, page)[table.rows] if files else ():
            read = files_of_rows(files, rows)
            path = place_of(run, read)
            if len(read) > 1:
                deep = len({file.parent for file in read}) > 1
                path /= "**/*.parquet" if deep else "*.parquet"
            yield Source(table, path.as_posix(), rows)


def _rows(run: Run, page: ObjectPage) -> dict[str, list[Rows]]:
    """Return the selections of rows by name; a selection maps columns to values."""
    best = [{"pipeline": table.name, "classifier": table.headline.key} for table in run.pipelines]
    return {
        "all": [{}],
        "pipelines": [{"pipeline": table.name} for table in run.pipelines],
        "best": list(best),
        "first best": list(best[:1]),
        "fixations": [{"strategy": "fixation"}],
        "view": [page.shown_rows],
        "touch": [{**page.shown_rows, "touch": 0}],
    }


def files_of_rows(files: Sequence[Path], rows: Rows) -> Sequence[Path]:
    """Return the files in the folder of the selected pipeline or object; all files if it has no folder.

    `rows` maps columns to values: ``pipeline``, or ``class`` and ``object``.
    """
    folder = str(rows.get("pipeline", f"{rows.get('class')}/{rows.get('object')}"))
    inside = [file for file in files if file.parent.as_posix().endswith(f"/{folder}")]
    return inside or files


def place_of(run: Run, files: Sequence[Path]) -> Path:
    """Return the path of a single file, or the common folder of several files, relative to the run's folder."""
    path = files[0] if len(files) == 1 else os.path.commonpath([file.parent for file in files])
    return Path(os.path.relpath(path, run.files.folder))
