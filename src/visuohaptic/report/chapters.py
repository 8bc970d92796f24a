"""The page's sections in order, each with the tables that it reads.

A new section needs three things: a function in `sections` that returns the values of its template, a template of
its name, and an entry in `CHAPTERS`. Studies outside the package bring their own sections
(`section.study_sections`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from jinja2 import Environment

from visuohaptic.base.errors import ReportError
from visuohaptic.report import sections
from visuohaptic.report.glossary import WORDS
from visuohaptic.report.questions import QUESTIONS
from visuohaptic.report.run import Run
from visuohaptic.report.section import (
    OTHER_OBJECTS,
    ReportContext,
    Section,
    SourceTable,
    figures_of,
    sentences_section,
    study_sections,
)
from visuohaptic.report.studies import names_of_own_studies
from visuohaptic.tables.phases import EFFECTS, FEATURES, FIXATIONS, PREDICTIONS, TOUCHES, VIEWS
from visuohaptic.tables.stability import STABILITY
from visuohaptic.tables.studies import (
    COST,
    EFFECT_INFLUENCE,
    EVALUATION,
    STUDY,
)

_SHARE = "share of rows with predicted = class, averaged over splits"


def _of_own_studies(run: Run) -> list[SourceTable]:
    return [figures_of(name) for name in names_of_own_studies(run)]


BEST = SourceTable(f"The best classifier: {_SHARE}", PREDICTIONS, "predictions", "best")
DRAWN = SourceTable("Further draws of random places", STUDY, "drawn")
COSTS = SourceTable("Settings of this run", COST, "frontier")
STABLE = SourceTable("Each object's numbers", STABILITY, "stability")
INFLUENCE = SourceTable(
    "Run time of effects, changes of images", EFFECT_INFLUENCE, "effect_influence"
)

CHAPTERS = {
    "Method": (
        Section(
            "method", "The method on one object of this run", sections.method_values,
            (
                SourceTable("The touches shown", TOUCHES, "touches", "view"),
                SourceTable("Contourlet deviations, 01 to 16", FEATURES, "features", "touch"),
                SourceTable("Channels of attention", VIEWS, "views"),
            ),
        ),
    ),
    "Answers": (
        Section(
            "answer", "Answers of this run", sections.answer_values, (BEST, DRAWN, COSTS),
        ),
    ),
    "Objects": (
        Section(
            "objects", "The objects", sections.objects_values,
            (
                SourceTable("Views and maps", VIEWS, "views"),
                SourceTable("Fixations, and which were touched", FIXATIONS, "fixations", "fixations"),
                SourceTable("Imprints, sizes and contact states", TOUCHES, "touches"),
                SourceTable("Classes predicted", PREDICTIONS, "predictions", "first best"),
            ),
        ),
    ),
    "Classifiers": (
        Section(
            "comparison", "The classifiers", sections.comparison_values,
            (
                SourceTable(f"Accuracy: {_SHARE}", PREDICTIONS, "predictions", "pipelines"),
                DRAWN,
            ),
        ),
        Section(
            "confusion", "Which classes are confused", sections.confusion_values,
            (SourceTable("Number of rows", PREDICTIONS, "predictions", "first best"),),
        ),
        Section(
            "evaluation", "Objects that the model has not learnt", sections.evaluation_values,
            (SourceTable("Objects not learnt", EVALUATION, "evaluation"),),
        ),
    ),
    "Cost": (Section("cost", "What accuracy costs in time", sections.cost_values, (COSTS,)),),
    "Studies": (
        Section("studies", "Own studies", sections.own_studies_values, _of_own_studies),
    ),
    "Simulation": (
        Section(
            "effects", "Effects that the scene needs", sections.effects_values,
            (
                SourceTable("Effects", EFFECTS, "effects"),
                INFLUENCE,
                figures_of("effects"),
            ),
        ),
        Section(
            "stability", "Numerical stability in hard cases", sections.stability_values, (STABLE,),
        ),
    ),
    OTHER_OBJECTS: (
        sentences_section(
            "hard-cases", "Hard cases of the code", sections.hard_cases_sentences, OTHER_OBJECTS,
        ),
    ),
    "Methods": (
        Section("methods", "Methods text", sections.methods_values),
        Section("parameters", "Parameters", sections.parameters_values),
        Section(
            "credits", "Credits",
            lambda context: {"objects": context.run.objects, "credits": context.run.credits},
        ),
        Section("provenance", "What ran, where and how long", sections.provenance_values),
        Section("glossary", "Glossary", lambda _: {"words": WORDS}),
    ),
}  # fmt: skip
"""The sections by chapter; the table of contents lists the chapters. Studies bring further sections."""


def chapters_of(run: Run) -> dict[str, tuple[Section, ...]]:
    """Return the sections of a run's page by chapter; a chapter begins with the sections that studies bring to it.

    Sections that answer one of `QUESTIONS` come first, then the others by the names of their studies. Without a section
    of a study, chapter `OTHER_OBJECTS` is left out. Raises `ReportError` if a study names an unknown chapter.
    """
    brought: dict[str, list[Section]] = {name: [] for name in CHAPTERS}
    for section in study_sections(run.files.study_folders):
        if section.chapter not in CHAPTERS:
            raise ReportError(
                f"{section.folder}/section.py: {section.chapter!r} is no chapter of the report; one of "
                f"{', '.join(CHAPTERS)} is needed."
            )
        brought[section.chapter].append(section)
    for of_studies in brought.values():
        of_studies.sort(key=lambda section: section.title not in QUESTIONS.values())
    return {
        name: (*brought[name], *sections_of_report)
        for name, sections_of_report in CHAPTERS.items()
        if name != OTHER_OBJECTS or brought[name]
    }


def render_chapters(
    environment: Environment, context: ReportContext, chapters: Mapping[str, Sequence[Section]]
) -> dict[str, list[tuple[str, str, str]]]:
    """Render the sections with values; return name, title and HTML of each, by chapter."""
    rendered: dict[str, list[tuple[str, str, str]]] = {}
    for chapter, of_chapter in chapters.items():
        for section in of_chapter:
            values = section.values(context)
            if values is not None:
                body = environment.get_template(section.template_path).render(values)
                title = values.get("title", section.title)
                rendered.setdefault(chapter, []).append((section.name, title, body))
    return rendered
