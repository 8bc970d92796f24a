"""The page's sections in the order in which they appear, each with the tables that it reads.

A new section is a function that gives its words and figures, such as one of `sections`, a template of
its name, and its entry here.
"""

from __future__ import annotations

from pathlib import Path

from visuohaptic.gaze.stored import read_measured
from visuohaptic.report import sections
from visuohaptic.report.gaze import gaze_figures
from visuohaptic.report.glossary import WORDS
from visuohaptic.report.objects import ObjectPage
from visuohaptic.report.run import Run
from visuohaptic.report.section import Reads, Rows, Section, given
from visuohaptic.report.studies import read_own_studies, read_study
from visuohaptic.report.touches_needed import curve_figures
from visuohaptic.studies.registry import PACKAGED
from visuohaptic.tables.gaze import GAZE, GAZE_PICTURES
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.phases import EFFECTS, FEATURES, FIXATIONS, PREDICTIONS, TOUCHES, VIEWS
from visuohaptic.tables.stability import STABILITY
from visuohaptic.tables.studies import (
    CERTAINTY,
    COST,
    EFFECT_INFLUENCE,
    EVALUATION,
    LOOKING,
    STUDY_FIGURES,
    TOUCHES_NEEDED,
)

_SHARE = "share of rows with predicted = class, averaged over splits"
_VOTES = "Whole objects: voted, or the majority of predicted where it is missing"


def each_pipeline(run: Run, _: ObjectPage) -> list[Rows]:
    """Select the rows of each pipeline."""
    return [{"pipeline": table.name} for table in run.pipelines]


def each_best(run: Run, _: ObjectPage) -> list[Rows]:
    """Select the rows of each pipeline's best classifier."""
    return [{"pipeline": table.name, "classifier": table.best.key} for table in run.pipelines]


def first_best(run: Run, page: ObjectPage) -> list[Rows]:
    """Select the rows of the first pipeline's best classifier."""
    return each_best(run, page)[:1]


def shown_view(_: Run, page: ObjectPage) -> list[Rows]:
    """Select the view that explains the method."""
    return [page.shown_rows]


def shown_touch(run: Run, page: ObjectPage) -> list[Rows]:
    """Select the first touch of that view."""
    return [{**rows, "touch": 0} for rows in shown_view(run, page)]


BEST = Reads(f"The best classifier: {_SHARE}", PREDICTIONS, "predictions", each_best)
COSTS = (
    Reads("Settings of this run", COST, "frontier"),
    Reads("The whole study", COST, "cost"),
)
STABLE = Reads("Each object's numbers", STABILITY, "stability")
INFLUENCE = Reads("Run time of effects, changes of images", EFFECT_INFLUENCE, "effect_influence")


def of_study(name: str) -> Reads:
    """Give what a section reads of a study."""
    return Reads(f"Study {name}", STUDY_FIGURES, f"studies/{name}")


def of_own_studies(run: Run) -> list[Reads]:
    """Give what the page reads of the user's own studies."""
    files = sorted(Path(run.files.extras.get("studies", "nowhere")).glob("*.parquet"))
    return [of_study(file.stem) for file in files if file.stem not in PACKAGED]


CHAPTERS = {
    "Answers": (
        Section(
            "answer", "Answers", sections.answer_values, (BEST, *COSTS, STABLE, INFLUENCE),
        ),
        Section(
            "method", "The method on one object of this run", sections.method_values,
            (
                Reads("The touches shown", TOUCHES, "touches", shown_view),
                Reads("Contourlet deviations, 01 to 16", FEATURES, "features", shown_touch),
            ),
        ),
    ),
    "Comparison": (
        Section(
            "comparison", sections.comparison_title, sections.comparison_values,
            (
                Reads(f"Accuracy: {_SHARE}", PREDICTIONS, "predictions", each_pipeline),
                Reads(_VOTES, PREDICTIONS, "predictions", each_pipeline),
            ),
        ),
        Section(
            "touches_needed", "Accuracy against touches",
            lambda context: given(
                pipelines=curve_figures(context.run.file_of("studies"), context.run.file_of("touches_needed"))
            ),
            (
                Reads("Area and touches needed", TOUCHES_NEEDED, "touches_needed"),
                of_study("curves"),
            ),
        ),
        Section(
            "confusion", "Which classes are confused", sections.confusion_values,
            (Reads("Number of rows", PREDICTIONS, "predictions", first_best),),
        ),
        Section(
            "certainty", "How sure answers are", sections.certainty_values,
            (
                Reads("Known and unknown objects", CERTAINTY, "certainty"),
                Reads("Objects not learnt", EVALUATION, "evaluation"),
            ),
        ),
        Section(
            "looking", "What the eye alone recognises, and what touch adds", sections.looking_values,
            (Reads("Looking, touching and both", LOOKING, "looking"),),
        ),
    ),
    "Cost": (Section("cost", "What accuracy costs in time", sections.cost_values, COSTS),),
    "Hard cases": (
        Section(
            "stability", "Numerical stability in hard cases", sections.stability_values, (STABLE,),
        ),
        Section(
            "guards", "Guards of this run's claim", sections.guards_values,
            (Reads("The guards", GUARDS, "guards"),),
        ),
    ),
    "Effects": (
        Section(
            "influence", "Which effects a scene needs", sections.influence_values,
            (
                INFLUENCE,
                of_study("effects"),
                Reads("Places touched in each scene", TOUCHES, "touches", shown_view),
            ),
        ),
        Section(
            "effects", "Simulated effects, and effects not needed", sections.effects_values,
            (Reads("Effects", EFFECTS, "effects"), Reads("Channels of attention", VIEWS, "views")),
        ),
    ),
    "Objects": (
        Section(
            "objects", "The objects", sections.objects_values,
            (
                Reads("Views and maps", VIEWS, "views"),
                Reads("Fixations, and which were touched", FIXATIONS, "fixations",
                    lambda _, __: [{"strategy": "fixation"}]),
                Reads("Imprints, sizes and contact states", TOUCHES, "touches"),
                Reads("Classes predicted", PREDICTIONS, "predictions", first_best),
            ),
        ),
    ),
    "Studies": (
        Section(
            "readings", "The paper under all its readings",
            lambda context: {"readings": context.readings},
        ),
        Section(
            "gaze", "Attention compared with human gaze",
            lambda context: {
                "gaze": gaze_figures(
                    read_measured(context.run.file_of("gaze")), context.run.file_of("gaze_pictures")
                )
            },
            (
                Reads("Predictions against people", GAZE, "gaze"),
                Reads("Pictures", GAZE_PICTURES, "gaze_pictures"),
            ),
        ),
        Section(
            "ablations", "Ablations",
            lambda context: given(study=read_study(context.run.file_of("studies"), "ablations")),
            (of_study("ablations"),),
        ),
        Section(
            "studies", "Own studies",
            lambda context: given(studies=read_own_studies(context.run.file_of("studies"))),
            of_own_studies,
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
"""The sections by their entry in the table of contents."""
