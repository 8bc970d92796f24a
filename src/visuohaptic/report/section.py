"""A section of the page: its title, the values of its template, and the tables that it reads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
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
from visuohaptic.tables.studies import STUDY_FIGURES

OTHER_OBJECTS = "Other objects"
"""The chapter of results that were measured before on named objects; the page folds its sections."""

Values = Mapping[str, Any]


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
        The selected rows, a name in `sources._rows`.
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
        """The template's name for `environment.make_environment`; names of studies have the section's name as a folder."""
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
