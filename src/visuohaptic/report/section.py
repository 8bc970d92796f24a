"""A section of the page: its title, the values of its template, and the tables that it reads."""

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
from visuohaptic.report.objects import ObjectPage, most_varied
from visuohaptic.report.provenance import PhaseSeconds
from visuohaptic.report.run import Run
from visuohaptic.studies.registry import import_file, section_files
from visuohaptic.tables.schema import Schema
from visuohaptic.tables.schemas import SCHEMAS
from visuohaptic.tables.studies import STUDY_FIGURES

OTHER_OBJECTS = "Other objects"
"""The chapter of results that were measured before on named objects; the page folds its sections."""

Values = Mapping[str, Any]
Rows = Mapping[str, str | int]


@dataclass(frozen=True)
class SourceTable:
    """A table that a section shows.

    Attributes
    ----------
    what : str
        The part of the table that the section shows, in words.
    schema : Schema
        The schema of the table.
    files : str
        The name of the files, as for `Run.parts`.
    rows : str
        The selected rows, a name in `_rows`.
    """

    what: str
    schema: Schema
    files: str
    rows: str = "all"


@dataclass(frozen=True)
class ReportContext:
    """The data of all sections; figures that several sections show are read once."""

    run: Run
    pages: Sequence[ObjectPage]
    seconds: Sequence[PhaseSeconds]

    @cached_property
    def frontier(self) -> Values | None:
        """Cost and accuracy of the settings of this run; None where nothing was measured."""
        return read_cost(self.run.extra_path("frontier"), self.run.parameters)

    @cached_property
    def influence(self) -> Values | None:
        """Run time of effects and their changes of images; None where nothing was measured."""
        path = self.run.extra_path("effect_influence")
        return influence_figures(path, self.run.parameters.scene.preset) if path else None

    @cached_property
    def explaining(self) -> ObjectPage:
        """The object on which section ``method`` explains the method."""
        return most_varied(self.pages)


@dataclass(frozen=True)
class Section:
    """One section of the page.

    Attributes
    ----------
    name : str
        The anchor of the section, and the name of its template without ``.html.jinja``.
    title : str
        The heading.
    values : callable
        Returns the values of the template, or None to leave the section out. A value ``title`` replaces the heading.
    reads : sequence of SourceTable, or callable
        The tables that the section reads.
    chapter : str
        The chapter of the page in which a section of a study stands, a key of `chapters.CHAPTERS`.
    template : str
        The file name of the template, in ``templates`` of the study's folder or else of the report. The default is
        ``section.html.jinja`` for a study, and the section's name with ``.html.jinja`` for the report.
    folder : Path, optional
        The folder of the study that brings the section.
    """

    name: str
    title: str
    values: Callable[[ReportContext], Values | None]
    reads: Sequence[SourceTable] | Callable[[Run], Sequence[SourceTable]] = ()
    chapter: str = "Studies"
    template: str = ""
    folder: Path | None = None

    @property
    def template_path(self) -> str:
        """The template's name for `page.make_environment`; names of studies have the section's name as a folder."""
        if self.folder is None:
            return self.template or f"{self.name}.html.jinja"
        return f"{self.name}/{self.template or 'section.html.jinja'}"


def figures_of(study: str) -> SourceTable:
    """Return the table of a study's figures as a source of a section."""
    return SourceTable(f"Study {study}", STUDY_FIGURES, f"studies/{study}")


def study_anchor(study: str, section: str = "") -> str:
    """Return the anchor of a section that a study brings to the page; the study's main section has the study's name."""
    names = [study] if section in {"", study} else [study, section]
    return "-".join(("study", *names)).replace("_", "-")


def study_sections(folders: Iterable[str | Path]) -> list[Section]:
    """Import the sections of the studies in some folders, sorted by the studies' names.

    A study brings a `Section` named ``SECTION`` or several named ``SECTIONS`` in its file ``section.py``. Their
    templates are in its folder ``templates``, or are templates of the report.

    Raises
    ------
    ReportError
        If a file ``section.py`` has no section.
    ParameterError
        If a file can't be imported.
    """
    sections: list[Section] = []
    for study, path in section_files(folders).items():
        module = import_file(path, study)
        brought: Sequence[Any] = getattr(module, "SECTIONS", ()) or [
            getattr(module, "SECTION", None)
        ]
        if not all(isinstance(section, Section) for section in brought):
            raise ReportError(
                f"{path} has no SECTION; one Section, or a sequence SECTIONS, is needed."
            )
        sections += [
            replace(section, name=study_anchor(study, section.name), folder=path.parent)
            for section in brought
        ]
    return sections


def sentences_section(
    name: str,
    title: str,
    sentences: Callable[[ReportContext], Iterable[str]],
    chapter: str = "Studies",
    reads: Sequence[SourceTable] = (),
) -> Section:
    """Return a section of paragraphs, one per sentence; without a sentence the section is left out.

    Parameters are fields of `Section`. Empty sentences are dropped.
    """

    def values(context: ReportContext) -> Values | None:
        said = [sentence for sentence in sentences(context) if sentence]
        return {"sentences": said} if said else None

    return Section(name, title, values, reads, chapter, "sentences.html.jinja")


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
