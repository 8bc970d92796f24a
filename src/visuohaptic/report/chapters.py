"""The page's sections in the order in which they appear, each with the tables that it reads.

A new section is a function that gives its words and figures, such as one of `sections`, a template of
its name, and its entry here.
"""

from __future__ import annotations

from visuohaptic.report import sections
from visuohaptic.report.glossary import WORDS
from visuohaptic.report.run import Run
from visuohaptic.report.section import Reads, Section
from visuohaptic.report.studies import names_of_own_studies
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


def _of_study(name: str) -> Reads:
    return Reads(f"Study {name}", STUDY_FIGURES, f"studies/{name}")


def _of_own_studies(run: Run) -> list[Reads]:
    return [_of_study(name) for name in names_of_own_studies(run.file_of("studies"))]


BEST = Reads(f"The best classifier: {_SHARE}", PREDICTIONS, "predictions", "best")
COSTS = (
    Reads("Settings of this run", COST, "frontier"),
    Reads("The whole study", COST, "cost"),
)
STABLE = Reads("Each object's numbers", STABILITY, "stability")
INFLUENCE = Reads("Run time of effects, changes of images", EFFECT_INFLUENCE, "effect_influence")

CHAPTERS = {
    "Answers": (
        Section(
            "answer", "Answers", sections.answer_values, (BEST, *COSTS, STABLE, INFLUENCE),
        ),
        Section(
            "method", "The method on one object of this run", sections.method_values,
            (
                Reads("The touches shown", TOUCHES, "touches", "view"),
                Reads("Contourlet deviations, 01 to 16", FEATURES, "features", "touch"),
            ),
        ),
    ),
    "Comparison": (
        Section(
            "comparison", "The classifiers", sections.comparison_values,
            (
                Reads(f"Accuracy: {_SHARE}", PREDICTIONS, "predictions", "pipelines"),
                Reads(_VOTES, PREDICTIONS, "predictions", "pipelines"),
            ),
        ),
        Section(
            "touches_needed", "Accuracy against touches", sections.touches_needed_values,
            (
                Reads("Area and touches needed", TOUCHES_NEEDED, "touches_needed"),
                _of_study("curves"),
            ),
        ),
        Section(
            "confusion", "Which classes are confused", sections.confusion_values,
            (Reads("Number of rows", PREDICTIONS, "predictions", "first best"),),
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
                _of_study("effects"),
                Reads("Places touched in each scene", TOUCHES, "touches", "view"),
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
                Reads("Fixations, and which were touched", FIXATIONS, "fixations", "fixations"),
                Reads("Imprints, sizes and contact states", TOUCHES, "touches"),
                Reads("Classes predicted", PREDICTIONS, "predictions", "first best"),
            ),
        ),
    ),
    "Studies": (
        Section(
            "readings", "The paper under all its readings",
            lambda context: {"readings": context.readings},
        ),
        Section("ablations", "Ablations", sections.ablations_values, (_of_study("ablations"),)),
        Section("studies", "Own studies", sections.own_studies_values, _of_own_studies),
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
