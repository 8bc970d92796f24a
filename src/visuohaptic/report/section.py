"""A section of the page: its title, its words and figures, and the tables that it reads."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from visuohaptic.report.cost import CostFigures, read_cost
from visuohaptic.report.influence import influence_figures
from visuohaptic.report.objects import ObjectPage, most_varied
from visuohaptic.report.provenance import PhaseSeconds
from visuohaptic.report.readings import ReadingsSummary, read_readings
from visuohaptic.report.run import Run
from visuohaptic.tables.schema import Schema

Values = Mapping[str, Any]
Rows = Mapping[str, str | int]
Selection = Callable[[Run, ObjectPage], Sequence[Rows]]


@dataclass(frozen=True)
class Reads:
    """A table that a section shows: what of it, and its schema.

    `files` are those of `RunFiles`, or one of its extras; ``studies/NAME`` for a study. `selection`
    gives the rows that are shown, a mapping of columns to values for each place on the page.
    """

    what: str
    schema: Schema
    files: str
    selection: Selection = lambda _, __: [{}]


@dataclass(frozen=True)
class ReportContext:
    """The data that sections are made from; what several show is read once."""

    run: Run
    pages: Sequence[ObjectPage]
    seconds: Sequence[PhaseSeconds]

    @cached_property
    def frontier(self) -> CostFigures | None:
        """What accuracy costs in this run."""
        return read_cost(self.run.file_of("frontier"), self.run.parameters)

    @cached_property
    def influence(self) -> Values | None:
        """What effects cost and change."""
        path = self.run.file_of("effect_influence")
        return influence_figures(path, self.run.parameters.scene.preset) if path else None

    @cached_property
    def readings(self) -> ReadingsSummary:
        """What the readings of the paper say together, of this run or as kept with the package."""
        return read_readings(self.run.file_of("readings"))

    @cached_property
    def explaining(self) -> ObjectPage:
        """The object that explains the method."""
        return most_varied(self.pages)


def given(**values: object) -> Values | None:
    """Give a section's values, or None where one of them is missing or empty."""
    return values if all(values.values()) else None


@dataclass(frozen=True)
class Section:
    """One section of the page: its anchor, which is the stem of its template, and its title.

    `values` gives the words and figures of the template; None leaves the section out. `reads` are the
    tables that it shows. Title and tables may depend on the run.
    """

    name: str
    title: str | Callable[[Run], str]
    values: Callable[[ReportContext], Values | None]
    reads: tuple[Reads, ...] | Callable[[Run], Sequence[Reads]] = ()

    def titled(self, run: Run) -> str:
        """Give the title for a run."""
        return self.title if isinstance(self.title, str) else self.title(run)

    def tables(self, run: Run) -> Sequence[Reads]:
        """Give what it reads of a run."""
        return self.reads(run) if callable(self.reads) else self.reads


@dataclass(frozen=True)
class Source:
    """What was read: `file` is a path, or a pattern of paths, relative to the run's folder."""

    reads: Reads
    file: str
    rows: Rows

    @property
    def filter(self) -> str:
        """The selected rows in words, such as ``classifier = naive_bayes``; empty for all."""
        return ", ".join(f"{column} = {value}" for column, value in self.rows.items())


def find_sources(reads: Sequence[Reads], run: Run, page: ObjectPage) -> Iterator[Source]:
    """Give what a section reads of a run; `page` is the object that explains the method."""
    for one in reads:
        files = run.parts(one.files)
        for rows in one.selection(run, page) if files else ():
            yield Source(one, _pattern(run, _narrowed(files, rows)), rows)


def _narrowed(files: Sequence[Path], rows: Rows) -> Sequence[Path]:
    """Keep the files of the pipeline or the object that is selected, where they have their own."""
    place = str(rows.get("pipeline", f"{rows.get('class')}/{rows.get('object')}"))
    own = [file for file in files if file.parent.as_posix().endswith(f"/{place}")]
    return own or files


def relative_to_run(run: Run, file: str | Path) -> Path:
    """Give a file's path as the page names it, from the run's folder."""
    return Path(os.path.relpath(file, run.files.folder))


def predictions_of(run: Run, pipeline: str) -> Sequence[Path]:
    """Give the files that hold a pipeline's predictions."""
    return _narrowed(run.parts("predictions"), {"pipeline": pipeline})


def folder_of(files: Sequence[Path]) -> Path:
    """Give the file, or the folder that holds all of several."""
    return (
        files[0] if len(files) == 1 else Path(os.path.commonpath([file.parent for file in files]))
    )


def _pattern(run: Run, files: Sequence[Path]) -> str:
    """Name files as one path or pattern, relative to the run's folder."""
    relative = [relative_to_run(run, file) for file in files]
    folder = folder_of(relative)
    if len(relative) == 1:
        return folder.as_posix()
    deep = any(file.parent != folder for file in relative)
    return (folder / ("**/*.parquet" if deep else "*.parquet")).as_posix()
