"""A section of the page: its title, its words and figures, and the tables that it reads."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from visuohaptic.base.errors import ReportError
from visuohaptic.report.cost import read_cost
from visuohaptic.report.effects import influence_figures
from visuohaptic.report.evaluation import evaluation_figures
from visuohaptic.report.objects import ObjectPage, most_varied
from visuohaptic.report.provenance import PhaseSeconds
from visuohaptic.report.run import Run
from visuohaptic.report.variants import VARIANTS, VariantsSummary, read_variants
from visuohaptic.studies.evaluation.models import read_evaluation
from visuohaptic.studies.registry import import_file, section_files
from visuohaptic.tables.schema import Schema
from visuohaptic.tables.schemas import SCHEMAS
from visuohaptic.tables.studies import STUDY_FIGURES

Values = Mapping[str, Any]
Rows = Mapping[str, str | int]


@dataclass(frozen=True)
class SourceTable:
    """A table that a section shows: what of it, which `files` as `Run.parts` takes them, and which `rows`, by a name in `_rows`."""

    what: str
    schema: Schema
    files: str
    rows: str = "all"


@dataclass(frozen=True)
class ReportContext:
    """The data that sections are made from; what several show is read once."""

    run: Run
    pages: Sequence[ObjectPage]
    seconds: Sequence[PhaseSeconds]

    @cached_property
    def frontier(self) -> Values | None:
        """What accuracy costs in this run."""
        return read_cost(self.run.file_of("frontier"), self.run.parameters)

    @cached_property
    def influence(self) -> Values | None:
        """What effects cost and change."""
        path = self.run.file_of("effect_influence")
        return influence_figures(path, self.run.parameters.scene.preset) if path else None

    @cached_property
    def variants(self) -> VariantsSummary:
        """What the variants of the paper say together, of this run or as kept with the package."""
        return read_variants(self.run.made(VARIANTS))

    @cached_property
    def evaluation(self) -> Values:
        """The model's answers for objects that it has not learnt, of this run or as kept with the package."""
        measured = read_evaluation(self.run.file_of("evaluation"))
        return evaluation_figures(measured, self.run.parameters.recognition.intervals)

    @cached_property
    def explaining(self) -> ObjectPage:
        """The object that explains the method."""
        return most_varied(self.pages)


@dataclass(frozen=True)
class Section:
    """One section of the page: its anchor, which is the stem of its template, its title, and what it reads.

    `values` gives the words and figures of the template; None leaves the section out, ``title`` is another title.
    """

    name: str
    title: str
    values: Callable[[ReportContext], Values | None]
    reads: Sequence[SourceTable] | Callable[[Run], Sequence[SourceTable]] = ()
    folder: Path | None = None

    @property
    def template(self) -> str:
        """The template's name; that of a study lies in its `folder` as ``templates/section.html.jinja``."""
        return f"{self.name}{'/section' if self.folder else ''}.html.jinja"


def figures_of(study: str) -> SourceTable:
    """Give the table of a study's figures, as a section reads it."""
    return SourceTable(f"Study {study}", STUDY_FIGURES, f"studies/{study}")


def study_anchor(study: str) -> str:
    """Name the section that a study brings to the page."""
    return f"study-{study.replace('_', '-')}"


def study_sections(folders: Iterable[str | Path]) -> list[Section]:
    """Import the sections of studies that lie in some folders, by the studies' names.

    A study's folder brings a section as `Section` named ``SECTION`` in ``section.py``, with its template
    ``templates/section.html.jinja``. Raises `ReportError` if a file can't be run or has no section.
    """
    found = []
    for study, path in section_files(folders).items():
        section = getattr(import_file(path, study), "SECTION", None)
        if not isinstance(section, Section):
            raise ReportError(f"{path} has no SECTION; one Section is needed.")
        found.append(replace(section, name=study_anchor(study), folder=path.parent))
    return found


@dataclass(frozen=True)
class Source:
    """What was read: `file` is a path, or a pattern of paths, relative to the run's folder."""

    reads: SourceTable
    file: str
    rows: Rows

    @property
    def is_listed(self) -> bool:
        """Whether `visuohaptic tables` lists the table's columns; tables of studies describe theirs in the file."""
        return self.reads.schema.name in SCHEMAS

    @property
    def filter(self) -> str:
        """The selected rows in words, such as ``classifier = naive_bayes``; empty for all."""
        return ", ".join(f"{column} = {value}" for column, value in self.rows.items())


def find_sources(section: Section, run: Run, page: ObjectPage) -> Iterator[Source]:
    """Give what a section reads of a run; `page` is the object that explains the method."""
    for one in section.reads(run) if callable(section.reads) else section.reads:
        files = run.parts(one.files)
        for rows in _rows(run, page)[one.rows] if files else ():
            own = files_of_rows(files, rows)
            place = place_of(run, own)
            if len(own) > 1:
                deep = len({file.parent for file in own}) > 1
                place /= "**/*.parquet" if deep else "*.parquet"
            yield Source(one, place.as_posix(), rows)


def _rows(run: Run, page: ObjectPage) -> dict[str, list[Rows]]:
    """Give the rows that are shown of a table, columns and values for each place on the page."""
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
    """Keep the files of the pipeline or the object that is selected, where they have their own."""
    place = str(rows.get("pipeline", f"{rows.get('class')}/{rows.get('object')}"))
    own = [file for file in files if file.parent.as_posix().endswith(f"/{place}")]
    return own or files


def place_of(run: Run, files: Sequence[Path]) -> Path:
    """Give the file, or the folder that holds all of several, as the page names it, from the run's folder."""
    alone = len(files) == 1
    place = files[0] if alone else os.path.commonpath([file.parent for file in files])
    return Path(os.path.relpath(place, run.files.folder))
