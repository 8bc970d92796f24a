"""The values of each section's template, from the tables of the run.

Each function ``…_values`` takes the context of the report and returns the values by name. None leaves the section out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from visuohaptic.attention.levels import CENTRE_LEVELS, SURROUND_OFFSETS
from visuohaptic.evaluation.intervals import EXTRA
from visuohaptic.evaluation.summary import confusion, select
from visuohaptic.features.descriptors import DESCRIPTORS
from visuohaptic.fixations.viewpoints import FIELD_OF_VIEW_DEGREES
from visuohaptic.io.checkout import find_commit
from visuohaptic.io.plugins import loaded
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.imprint_scale import imprint_scale
from visuohaptic.recognition.parameters import Protocol
from visuohaptic.recognition.sequences import filled_bands
from visuohaptic.report.comparison import PIPELINES, PipelineTable, draws_sentence, gain_sentence
from visuohaptic.report.cost import compared_sentence, cost_answer, robot_front
from visuohaptic.report.effects import (
    count_missing,
    count_passed_over,
    count_states,
    effect_rows,
    effects_answer,
    hard_places,
    rows_of_scenes,
    scene_strips,
    sum_channels,
    sum_effects,
)
from visuohaptic.report.held_out import held_out_figures
from visuohaptic.report.leads import PLACES, Lead, run_leads
from visuohaptic.report.own_fixations import own_fixations_rows, own_fixations_sentence
from visuohaptic.report.provenance import describe_machine, find_versions
from visuohaptic.report.questions import (
    MAIN_OPPONENT,
    QUESTIONS,
    Answer,
    has_opponent,
    lead_answer,
    recognition_answer,
    reproduction_answer,
    strategies_answer,
)
from visuohaptic.report.recounting import recount_accuracy, recount_cost, recount_lead
from visuohaptic.report.run import Run
from visuohaptic.report.section import ReportContext, Values
from visuohaptic.report.stability import (
    describe_checks,
    describe_hard_cases,
    read_hard_cases,
)
from visuohaptic.report.studies import names_of_own_studies, read_study
from visuohaptic.report.wording import CONTACT_STATES, percent, spaced, strategy_name, titled
from visuohaptic.sensor.placing import PENETRATION_TOLERANCE
from visuohaptic.studies.effects.influence import measured_scenes
from visuohaptic.tables.schema import matrix, read_table
from visuohaptic.tables.studies import EVALUATION

UNSEEN: Mapping[Protocol, str] = {
    "auto": "unseen objects",
    "leave_one_object_a_class_out": "unseen objects",
    "grouped_folds": "unseen objects",
    "new_viewpoint": "known objects from unseen viewpoints",
}
"""Test data that the classifier has not seen, in words, by protocol."""

NO_TOUCH = {
    "passed over": "no touch: the sensor can't reach the place, and the sequence goes on with a later place",
    "missing": "no touch: the sequence has no further place in reach",
}


def answer_values(context: ReportContext) -> Values:
    """Return the answers to the experiment's questions from this run, each with code that computes its number again."""
    run = context.run
    return {
        "answers": [
            replace(answer, recount=code if answer.number else "")
            for answer, code in _answers(context)
            if answer is not None
        ],
        "untested": not run.pipelines,
        "asked_last": QUESTIONS["salience"],
        "leads": leads_of_run(run) if run.pipelines else (),
        "frontier": context.frontier,
        "confidence": percent(run.parameters.recognition.intervals.confidence, 0),
    }


def leads_of_run(run: Run) -> tuple[Lead, ...]:
    """Return the leads of the run's own objects, by the headline classifier of each pipeline."""
    return run_leads(
        run.metrics,
        {table.name: table.headline.key for table in run.pipelines},
        run.parameters.meshes.turns,
        run.parameters.recognition.frame,
    )


def _answers(context: ReportContext) -> Iterator[tuple[Answer | None, str]]:
    run, recognition = context.run, context.run.parameters.recognition
    if run.pipelines:
        first, fixations = run.pipelines[0], run.parameters.attention.fixations
        touches = min(recognition.touches or fixations, fixations)
        unseen = UNSEEN[recognition.protocol.protocol]
        compared = next((table for table in run.pipelines if has_opponent(table)), first)
        rows = context.frontier["rows"] if context.frontier else []
        carried = compared_sentence(rows, "cues")
        yield (
            recognition_answer(
                run.pipelines,
                len(run.classes),
                touches,
                unseen,
                run.parameters.meshes.turns,
                [carried] if carried else [],
            ),
            recount_accuracy(run, first),
        )
        leads = leads_of_run(run)
        yield lead_answer("seeing", leads), recount_lead(run, compared)
        yield lead_answer("salience", leads), recount_lead(run, compared, "random_visible")
        yield _other_strategies(run, first)
        yield reproduction_answer(first), ""
    rows = context.frontier["rows"] if context.frontier else []
    for quickest in robot_front(rows, run.parameters.cost)[:1]:
        yield cost_answer(rows, run.parameters.cost), recount_cost(run, quickest)


def _other_strategies(run: Run, table: PipelineTable) -> tuple[Answer | None, str]:
    answer = strategies_answer(table)
    if answer is None:
        return None, ""
    other = next(name for name in table.headline.comparisons if name not in PLACES)
    return answer, recount_lead(run, table, other)


def method_values(context: ReportContext) -> Values:
    """Return one sequence of the run, from the view to the predicted classes."""
    page = context.explaining
    shown = select(context.run.features, **page.shown_rows, touch=0)
    own_fixations = context.run.own_fixations
    names = filled_bands(context.run.features)
    return {
        "page": page,
        "bands": matrix(shown, names)[0].tolist() if shown.num_rows else [],
        "described_by": described_by(context.run),
        "pipelines_text": " ".join(_pipeline_texts(context.run)),
        "channels": sum_channels(context.run.views),
        "own_fixations": own_fixations_sentence(own_fixations),
        "own_fixations_rows": own_fixations_rows(own_fixations),
    }


def described_by(run: Run) -> str:
    """Return the number and the kind of the numbers that describe an imprint."""
    entry = DESCRIPTORS[run.parameters.features.descriptor]
    kind = "contourlet numbers" if entry.name == "contourlet" else f"numbers ({entry.label})"
    return f"{len(filled_bands(run.features))} {kind}"


def _pipeline_texts(run: Run) -> list[str]:
    """Return the description of each pipeline of the run."""
    return [PIPELINES[table.name] for table in run.pipelines if table.name in PIPELINES]


def comparison_values(context: ReportContext) -> Values | None:
    """Return the tables of classifiers, with published accuracies where they are comparable."""
    run = context.run
    if not run.pipelines:
        return None
    first, *others = map(strategy_name, run.pipelines[0].strategies)
    against = others[0] if len(others) == 1 else f"{len(others)} other strategies"
    sentences = (
        gain_sentence(run.pipelines[0]),
        compared_sentence(context.frontier["rows"], "paper") if context.frontier else "",
    )
    return {
        "title": titled(f"{first} against {against}" if others else first),
        "sentences": [sentence for sentence in sentences if sentence],
        "tables": run.pipelines,
        "draws": draws_sentence(run.pipelines[0]),
        "method": run.metrics["method"],
    }


def evaluation_values(context: ReportContext) -> Values | None:
    """Return a model's predictions for objects of this run that it was not trained on; None if none were made."""
    path = context.run.extra_path("evaluation")
    if path is None:
        return None
    intervals = context.run.parameters.recognition.intervals
    return {"evaluation": held_out_figures(read_table(EVALUATION, path), intervals)}


def own_studies_values(context: ReportContext) -> Values | None:
    """Return the studies that bring no section of their own."""
    folder = context.run.extra_path("studies")
    found = [read_study(folder, name) for name in names_of_own_studies(context.run)]
    studies = [study for study in found if study]
    return {"studies": studies} if studies else None


def cost_values(context: ReportContext) -> Values | None:
    """Return the time and the accuracy of the settings of this run."""
    if context.run.extra_path("frontier") is None:
        return None
    return {"frontier": context.frontier, "objects": len(context.run.objects)}


def effects_values(context: ReportContext) -> Values:
    """Return how often each effect ran and why, its time and change of images, and imprints in all scenes."""
    run, page = context.run, context.explaining
    accuracy = read_study(run.extra_path("studies"), "effects", spaced)
    locations = select(run.fixations, **page.shown_rows)
    mesh = run.meshes.get(page.key) if locations.num_rows else None
    return {
        "page": page,
        "strips": scene_strips(mesh, locations, run.parameters) if mesh else {},
        "places": hard_places(run.parameters),
        "effects": effect_rows(
            sum_effects(run.effects), context.influence, run.parameters.scene.preset
        ),
        "influence": context.influence,
        "scale_of_scenes": imprint_scale(
            run.parameters.sensor,
            *measured_scenes(run.parameters.scene, run.parameters.sensor.layout).values(),
        ),
        "answer": effects_answer(context.influence["scenes"]) if context.influence else "",
        "accuracy": accuracy,
        "by_scene": rows_of_scenes(accuracy) if accuracy else [],
        "chance": 1 / max(len(run.classes), 1),
    }


def stability_values(context: ReportContext) -> Values | None:
    """Return the numerical checks on this run's objects; None if the run has none."""
    figures = context.run.stability
    if figures is None:
        return None
    return {
        "figures": figures,
        "shares": "; ".join(
            f"{name} {percent(max(check.share for check in checks), 1)}"
            for name, checks in figures.requirements.items()
        ),
        "anchors": {page.key: page.anchor for page in context.pages},
        "describe_checks": describe_checks,
    }


def hard_cases_sentences(context: ReportContext) -> Iterator[str]:
    """Yield the sentence on the hard cases of `make test-hard`, if the file of its figures exists."""
    path = context.run.extra_path("hard_cases")
    if path is not None:
        yield describe_hard_cases(read_hard_cases(path))


def confusion_values(context: ReportContext) -> Values | None:
    """Return the confusion matrices of the first pipeline's headline classifier, and the accuracy of each class."""
    if not context.run.pipelines:
        return None
    run, table = context.run, context.run.pipelines[0]
    row, shares = table.headline, table.headline.class_accuracy
    predicted = select(run.predictions, pipeline=table.name, classifier=row.key)
    return {
        "sentence": class_sentence(table),
        "matrices": [
            (row.name, strategy, confusion(select(predicted, strategy=strategy)))
            for strategy in table.strategies
            if strategy in row.accuracy
        ],
        "class_accuracy": [
            {
                "class": name,
                "by": {strategy: by_class.get(name) for strategy, by_class in shares.items()},
            }
            for name in run.classes
        ],
        "strategies": [name for name in table.strategies if name in shares],
    }


def class_sentence(table: PipelineTable) -> str:
    """Return a sentence on the classes that the headline classifier recognises most and least often."""
    shares = table.headline.class_accuracy.get(table.leading, {})
    if len(shares) < 2:
        return f"{titled(table.headline.name)}: a single class can't be confused."
    ordered = sorted(shares, key=lambda name: -shares[name].mean)
    most, least = (f"{name} ({percent(shares[name].mean)})" for name in (ordered[0], ordered[-1]))
    return (
        f"The {table.headline.name} recognises {most} most often, and {least} least often, "
        f"with {strategy_name(table.leading)}."
    )


def objects_values(context: ReportContext) -> Values:
    """Return every object, the number of touches in each contact state, and the number of places out of reach."""
    run = context.run
    states = count_states(run.touches)
    counts = {
        state: {strategy: by_state[state] for strategy, by_state in states.items()}
        for state in CONTACT_STATES
    }
    counts |= {"passed over": count_passed_over(run.touches), "missing": count_missing(run)}
    meanings = {**CONTACT_STATES, **NO_TOUCH}
    return {
        "pages": context.pages,
        "credits": run.credits,
        "best": run.pipelines[0].headline.name if run.pipelines else "classifier",
        "classes": run.classes,
        "strategies": sorted(states),
        "states": [
            {"state": state, "meaning": meanings[state], "counts": by_strategy}
            for state, by_strategy in counts.items()
        ],
        "objects": len(run.objects),
        "checks": {} if run.stability is None else run.stability.objects,
        "describe_checks": describe_checks,
    }


def methods_values(context: ReportContext) -> Values | None:
    """Return the parameters and constants of the methods text; None if nothing was tested."""
    run = context.run
    if not run.pipelines:
        return None
    weights = run.parameters.attention.weights.model_dump()
    sizes = Counter(key.split("/")[0] for key in run.tested_objects).values()
    compared = run.pipelines[0].headline.comparisons.get(MAIN_OPPONENT)
    return {
        "draws": compared.draws.count if compared and compared.draws else 1,
        "table": run.pipelines[0],
        "protocol": run.parameters.recognition.protocol.resolve(list(sizes)),
        "objects": len(run.objects),
        "classes": run.classes,
        "pipelines": _pipeline_texts(run),
        "numbers": len(filled_bands(run.features)),
        "descriptor": DESCRIPTORS[run.parameters.features.descriptor].label,
        "elevations": [f"{value:g}" for value in run.parameters.viewpoints.elevations_degrees],
        "weighted": [
            name if weight == 1.0 else f"{name} (weight {weight:g})"
            for name, weight in weights.items()
            if weight > 0
        ],
        "field_of_view_degrees": FIELD_OF_VIEW_DEGREES,
        "centre_levels": CENTRE_LEVELS,
        "surround_offsets": SURROUND_OFFSETS,
        "penetration_tolerance": PENETRATION_TOLERANCE,
        "extra_object": EXTRA,
    }


def parameters_values(context: ReportContext) -> Values:
    """Return every parameter that affects results, with its value and meaning."""
    model: ExperimentParameters = context.run.parameters
    return {
        "rows": [
            row
            for name in type(model).model_fields
            # No result depends on how work is divided; plug-ins have a sentence of their own.
            if name not in {"seed", "workflow", "plugins"}
            for row in _flattened(getattr(model, name), name)
        ],
        "plug_ins": [plug_in.package or Path(plug_in.source).name for plug_in in loaded()],
        "seed": model.seed,
    }


def provenance_values(context: ReportContext) -> Values:
    """Return versions, commit, machine, and the seconds of each phase."""
    return {
        "versions": find_versions(),
        "commit": find_commit(),
        "key": context.run.files.key,
        "machine": describe_machine(),
        "seconds": context.seconds,
    }


def _flattened(model: Any, path: str) -> list[dict[str, str]]:
    rows: list[dict[str, str]] = []
    for name, field in type(model).model_fields.items():
        value, key = getattr(model, name), f"{path}.{name}"
        if hasattr(type(value), "model_fields"):
            rows += _flattened(value, key)
        else:
            meaning = field.description or ""
            rows.append({"parameter": key, "value": _written(value), "meaning": meaning})
    return rows


def _written(value: object) -> str:
    if isinstance(value, tuple | list):
        return ", ".join(_written(item) for item in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None:
        return "none"
    return f"{value:g}" if isinstance(value, float) else str(value)
