"""The words and figures of each section, from the tables of the run.

A function gives the values of its section's template, or None where the run has nothing for it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.gaze.stored import read_measured
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.plugins import loaded
from visuohaptic.recognition.parameters import Protocol
from visuohaptic.recognition.splits import settled_protocol
from visuohaptic.recognition.summary import Confusion, confusion, select
from visuohaptic.report import figures
from visuohaptic.report.certainty import certainty_figures, evaluation_figures
from visuohaptic.report.comparison import (
    PIPELINES,
    PipelineTable,
    gain_sentence,
)
from visuohaptic.report.cost import (
    CostFigures,
    cost_figures,
    cost_verdict,
    cue_sentences,
    read_cost,
    time_parts,
)
from visuohaptic.report.effects import sum_channels, sum_effects
from visuohaptic.report.gaze import gaze_figures
from visuohaptic.report.glossary import WORDS
from visuohaptic.report.influence import (
    effects_answer,
    hard_places,
    influence_figures,
    rows_of_scenes,
    scene_strips,
)
from visuohaptic.report.looking import looking_figures
from visuohaptic.report.objects import ObjectPage, most_varied
from visuohaptic.report.provenance import (
    describe_machine,
    find_commit,
    find_versions,
)
from visuohaptic.report.questions import (
    BEST_OF_PAPER,
    MAIN_OPPONENT,
    Answer,
    fixation_answer,
    has_opponent,
    readings_sentence,
    recognition_answer,
    reproduction_answer,
)
from visuohaptic.report.readings import readings_figures
from visuohaptic.report.recounting import recount_accuracy, recount_cost, recount_lead
from visuohaptic.report.run import Run
from visuohaptic.report.section import ReportContext, Values
from visuohaptic.report.stability import (
    describe_checks,
    read_precision,
    stability_answer,
    stability_figures,
)
from visuohaptic.report.studies import (
    StudyFigures,
    read_own_studies,
    read_study,
    remade_name,
)
from visuohaptic.report.touches_needed import CurveFigures, curve_figures
from visuohaptic.report.wording import CONTACT_STATES, percent, strategy_name, titled
from visuohaptic.scene.parameters import PRESETS, VISUAL_EFFECTS
from visuohaptic.stability.stored import stored_hard_cases
from visuohaptic.studies.cost.front import first_step, on_robot
from visuohaptic.studies.cost.stored import stored_frontier
from visuohaptic.studies.evaluation.models import read_evaluation
from visuohaptic.studies.figures import Row
from visuohaptic.studies.readings.stored import (
    OUTSIDE,
    MeasuredReadings,
    kept_readings,
    read_readings,
)
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.phases import CONTOURLET_FEATURES
from visuohaptic.tables.schema import matrix, read_table

UNSEEN: Mapping[Protocol, str] = {
    "auto": "unseen objects",
    "leave_one_object_a_class_out": "unseen objects",
    "grouped_folds": "unseen objects",
    "new_viewpoint": "known objects from unseen viewpoints",
}
"""What is new to the classifier in a test, by protocol."""


def comparison_title(run: Run) -> str:
    """Name the strategies that the run compares: two by their names, more by the first."""
    first, *others = (strategy_name(name) for name in run.pipelines[0].strategies)
    if not others:
        return titled(first)
    other = others[0] if len(others) == 1 else f"{len(others)} other strategies"
    return f"{titled(first)} against {other}"


def answer_values(context: ReportContext) -> Values:
    """Give the question's answer."""
    run = context.run
    recognition = run.parameters.recognition
    touches = min(
        recognition.touches or run.parameters.attention.fixations,
        run.parameters.attention.fixations,
    )
    cost = read_cost(run.files.extras.get("frontier"), run.parameters)
    unseen = UNSEEN[recognition.protocol.protocol]
    answers = (
        *_recognition_answers(run, touches, unseen),
        _cost_answer(run, cost) if cost else None,
    )
    influence = influence_figures(
        run.files.extras.get("effect_influence"), run.parameters.scene.preset
    )
    return {
        "answers": [one for one in answers if one is not None],
        "untested": not run.pipelines,
        "effects": effects_answer(influence) if influence else None,
        "stability": _stability_answer(run),
    }


def _recognition_answers(run: Run, touches: int, unseen: str) -> tuple[Answer | None, ...]:
    """Answer what only recognition can; nothing where it tested no object."""
    if not run.pipelines:
        return ()
    first = run.pipelines[0]
    accuracy = recount_accuracy(run, first)
    compared = next((table for table in run.pipelines if has_opponent(table)), first)
    return (
        _recounted(recognition_answer(run.pipelines, len(run.classes), touches, unseen), accuracy),
        _recounted(
            fixation_answer(run.pipelines, _readings_by_set(run)),
            recount_lead(run, compared, MAIN_OPPONENT),
        ),
        _recounted(reproduction_answer(first), accuracy),
    )


def _recounted(answer: Answer | None, lines: str) -> Answer | None:
    """Add the lines that count an answer's number again; an answer may have no number."""
    return replace(answer, recount=lines) if answer is not None and answer.number else answer


def _cost_answer(run: Run, cost: CostFigures) -> Answer | None:
    first = first_step(cost.rows)
    return None if first is None else _recounted(cost_verdict(cost), recount_cost(run, first))


def _stability_answer(run: Run) -> str | None:
    """Give how exact numbers are where the run has checked its objects."""
    if run.stability is None:
        return None
    stored = stored_hard_cases()
    kept = () if stored is None else (stability_figures(stored.table),)
    return stability_answer([run.stability, *kept])


def method_values(context: ReportContext) -> Values:
    """Give one real sequence, from the view to the answer."""
    page = most_varied(context.pages)
    features = context.run.features
    of_touch = select(
        features,
        **{"class": page.category},
        object=page.name,
        viewpoint=page.shown.viewpoint,
        strategy="fixation",
        touch=0,
    )
    bands: list[float] = []
    if of_touch.num_rows:
        bands = matrix(of_touch, CONTOURLET_FEATURES)[0].tolist()
    return {
        "page": page,
        "bands": bands,
        "chart": figures.bands(bands) if bands else None,
        "pipelines_text": " ".join(_pipeline_texts(context.run)),
    }


def _pipeline_texts(run: Run) -> list[str]:
    """Say what each pipeline of the run is, and why."""
    return [PIPELINES[table.name] for table in run.pipelines if table.name in PIPELINES]


def comparison_values(context: ReportContext) -> Values | None:
    """Give the table of classifiers, beside the published one where it is comparable."""
    tables = context.run.pipelines
    if not tables:
        return None
    cost = read_cost(context.run.files.extras.get("frontier"), context.run.parameters)
    sentences = (
        gain_sentence(tables[0]),
        readings_sentence(_readings_by_set(context.run)),
        *(cue_sentences(cost.rows) if cost else ()),
    )
    return {
        "sentences": [sentence for sentence in sentences if sentence],
        "tables": [
            (table, figures.comparison(context.run.metrics, table.name)) for table in tables
        ],
        "method": context.run.metrics["method"],
    }


def touches_needed_values(context: ReportContext) -> Values | None:
    """Give the curves of accuracy against touches, where they were measured."""
    extras = context.run.files.extras
    found = curve_figures(extras.get("studies"), extras.get("touches_needed"))
    return {"pipelines": found, "charts": [_curves(one) for one in found]} if found else None


def _curves(found: CurveFigures) -> object:
    return figures.touches_needed([row for rows in found.curves.values() for row in rows])


def certainty_values(context: ReportContext) -> Values:
    """Give how sure answers are, or None where it was not measured; on new objects also as kept."""
    extras, parameters = context.run.files.extras, context.run.parameters
    certainty = certainty_figures(extras.get("certainty"), extras.get("certainty_figures"))
    return {
        "certainty": certainty,
        "coverage": figures.coverage(certainty.table) if certainty and certainty.enough else None,
        "evaluation": evaluation_figures(
            read_evaluation(extras.get("evaluation")),
            parameters.recognition.intervals,
            parameters.seed,
        ),
    }


def looking_values(context: ReportContext) -> Values | None:
    """Give what the eye alone recognises and what touch adds, or None where it was not measured."""
    found = looking_figures(context.run.files.extras.get("looking_figures"))
    return {"looking": found, "times": figures.looking(found.curves)} if found else None


def _measured_readings(run: Run) -> MeasuredReadings | None:
    return read_readings(run.files.extras.get("readings"))


def _readings_by_set(run: Run) -> dict[str, Sequence[Row]]:
    """Give the readings of the paper by set of objects: this run's or the kept ones."""
    found = {"paper": _measured_readings(run), "outside": kept_readings(OUTSIDE)}
    return {name: measured.rows for name, measured in found.items() if measured is not None}


def gaze_values(context: ReportContext) -> Values:
    """Give how attention agrees with people, of this run or as kept with the package."""
    extras = context.run.files.extras
    found = gaze_figures(read_measured(extras.get("gaze")), extras.get("gaze_pictures"))
    return {"gaze": found, "chart": figures.gaze(found.shown) if found else None}


def readings_values(context: ReportContext) -> Values | None:
    """Give what the readings of the paper say together, of this run or as kept with the package."""
    measured = _measured_readings(context.run)
    found = readings_figures(measured, kept_readings(OUTSIDE), (BEST_OF_PAPER,))
    return {"readings": found} if found else None


def ablations_values(context: ReportContext) -> Values | None:
    """Give the ablations, where they were measured."""
    found = read_study(context.run.files.extras.get("studies"), "ablations")
    if found is None:
        return None
    return {"study": found, "chart": _conditions(found), "remade": remade_name}


def _conditions(study: StudyFigures) -> object:
    cells = study.tables[0].cells
    measured = any(cell["accuracy"] is not None for cell in cells)
    return figures.conditions(cells) if measured else None


def studies_values(context: ReportContext) -> Values | None:
    """Give the user's own studies, where they were measured."""
    found = read_own_studies(context.run.files.extras.get("studies"))
    if not found:
        return None
    return {"studies": found, "charts": [_conditions(one) for one in found], "remade": remade_name}


def cost_values(context: ReportContext) -> Values | None:
    """Give what accuracy costs in time: in this run, and in the whole study where it was made."""
    extras, parameters = context.run.files.extras, context.run.parameters
    frontier, study = (read_cost(extras.get(name), parameters) for name in ("frontier", "cost"))
    if frontier is None and study is None:
        return None
    stored = stored_frontier()
    large = None if stored is None else cost_figures(stored.rows, parameters)
    return {
        "frontier": frontier,
        "objects": len(context.run.objects),
        "stored": stored,
        "large": large,
        "study": study,
        "charts": {
            **_cost_charts("frontier", frontier, parameters),
            **_cost_charts("large", large, parameters),
            **_time_chart("study", study),
            **_parts_chart(frontier),
        },
    }


def _cost_charts(
    name: str, found: CostFigures | None, parameters: ExperimentParameters
) -> dict[str, object]:
    """Draw computing time, and a robot's time."""
    if found is None or not figures.timed(found.rows):
        return {}
    robot = on_robot(found.rows, parameters.cost)
    return {
        **_time_chart(name, found),
        f"{name}-robot": figures.cost(robot, "time of a recognition by a robot"),
    }


def _time_chart(name: str, found: CostFigures | None) -> dict[str, object]:
    """Draw computing time; nothing where no setting was both run and timed."""
    if found is None or not figures.timed(found.rows):
        return {}
    return {name: figures.cost(found.rows)}


def _parts_chart(frontier: CostFigures | None) -> dict[str, object]:
    if frontier is None or not time_parts(frontier.reference):
        return {}
    return {"parts": figures.parts_of_time(frontier.rows)}


def effects_values(context: ReportContext) -> Values:
    """Give what was simulated and computed, and what was not needed."""
    table = context.run.effects
    effects = [] if table is None else sum_effects(table)
    preset = context.run.parameters.scene.preset
    return {
        "groups": [
            (title, noun, [row for row in effects if (row["effect"] in VISUAL_EFFECTS) == seen])
            for title, noun, seen in (
                ("Effects of the view", "views", True),
                (f"Effects of touch in the scene {preset}", "touches", False),
            )
        ],
        "channels": sum_channels(context.run.views),
    }


def influence_values(context: ReportContext) -> Values:
    """Give hard places, and what effects cost and change where that was measured."""
    extras, scene = context.run.files.extras, context.run.parameters.scene
    page = most_varied(context.pages)
    accuracy = read_study(extras.get("studies"), "effects")
    by_scene = [] if accuracy is None else rows_of_scenes(accuracy)
    return {
        "page": page,
        "strips": _scene_strips(context.run, page),
        "places": hard_places(context.run.parameters),
        "influence": influence_figures(extras.get("effect_influence"), scene.preset),
        "effects_answer": effects_answer,
        "accuracy": accuracy,
        "by_scene": by_scene,
        "scene_charts": [
            figures.conditions(rows, 1 / max(len(context.run.classes), 1)) for _, rows in by_scene
        ],
        "remade": remade_name,
        "scenes": list(PRESETS),
    }


def stability_values(context: ReportContext) -> Values | None:
    """Give how exact numbers are: on this run's objects, and in hard cases as kept with the package."""
    stored = stored_hard_cases()
    found = {
        "Objects of this run": context.run.stability,
        "Hard cases of the code": None if stored is None else stability_figures(stored.table),
    }
    kernels = read_precision(context.run.files.extras.get("precision"))
    parts = [
        (title, checked, describe_checks(checked.checks))
        for title, checked in found.items()
        if checked is not None
    ]
    if not parts and not kernels:
        return None
    return {
        "parts": parts,
        "chart": figures.stability(parts[-1][1].table) if parts else None,
        "made": {} if stored is None else stored.made,
        "further": {} if stored is None else stored.further,
        "kernels": kernels,
        "anchors": {page.key: page.anchor for page in context.pages},
    }


def guards_values(context: ReportContext) -> Values | None:
    """Give what the run's guards found."""
    path = context.run.files.extras.get("guards")
    if path is None or not Path(path).is_file():
        return None
    return {"rows": read_table(GUARDS, [path]).to_pylist()}


def confusion_values(context: ReportContext) -> Values | None:
    """Give the confusion matrices, the best classifier first."""
    if not context.run.pipelines:
        return None
    run, table = context.run, context.run.pipelines[0]
    found: list[tuple[str, str, Confusion]] = []
    rows = sorted(table.rows, key=lambda row: row is not table.best)
    for row in rows:
        for strategy in table.strategies:
            if strategy in row.accuracy:
                chosen = select(
                    run.predictions, pipeline=table.name, strategy=strategy, classifier=row.key
                )
                found.append((row.name, strategy, confusion(chosen)))
    best = [entry for entry in found if entry[0] == table.best.name]
    return {
        "sentence": class_sentence(table),
        "best": best,
        "others": [entry for entry in found if entry not in best],
        "best_row": table.best,
        "strategies": table.strategies,
        "classes": run.classes,
    }


def class_sentence(table: PipelineTable) -> str:
    """Say which classes the best classifier finds most and least often."""
    shares = table.best.class_accuracy.get(table.leading, {})
    if len(shares) < 2:
        return f"{titled(table.best.name)}: one class alone can't be confused."
    ordered = sorted(shares, key=lambda name: -shares[name].mean)
    most, least = (f"{name} ({percent(shares[name].mean)})" for name in (ordered[0], ordered[-1]))
    return (
        f"Of the classes, the {table.best.name} finds {most} most often, and {least} least often, "
        f"with {strategy_name(table.leading)}."
    )


def count_states(touches: pa.Table) -> dict[str, Counter[str]]:
    """Count the touches in each contact state, by strategy."""
    rows = touches.group_by(["strategy", "contact_state"]).aggregate([([], "count_all")])
    found: dict[str, Counter[str]] = {}
    for row in rows.to_pylist():
        found.setdefault(row["strategy"], Counter())[row["contact_state"]] = row["count_all"]
    return found


def count_passed_over(touches: pa.Table) -> Counter[str]:
    """Count the places that were passed over for being out of reach, by strategy."""
    sequence = ["class", "object", "viewpoint", "strategy"]
    found = touches.group_by(sequence).aggregate([("rank", "max"), ("rank", "count_distinct")])
    counts: Counter[str] = Counter()
    for row in found.to_pylist():
        counts[row["strategy"]] += row["rank_max"] + 1 - row["rank_count_distinct"]
    return counts


def count_missing(run: Run) -> Counter[str]:
    """Count the touches that were asked for and not made, by strategy."""
    asked = run.views.num_rows * run.parameters.attention.fixations
    made = Counter(run.touches.column("strategy").to_pylist())
    return Counter({strategy: asked - count for strategy, count in made.items()})


def objects_values(context: ReportContext) -> Values:
    """Give every object, how often each kind of contact was met, and what was out of reach."""
    states = count_states(context.run.touches)
    return {
        "pages": context.pages,
        "credits": context.run.credits,
        "best": context.run.pipelines[0].best.name if context.run.pipelines else "classifier",
        "classes": context.run.classes,
        "strategies": sorted(states),
        "states": states,
        "passed_over": count_passed_over(context.run.touches),
        "missing": count_missing(context.run),
        "objects": len(context.run.objects),
        "meanings": CONTACT_STATES,
        "checks": {} if context.run.stability is None else context.run.stability.objects,
        "describe_checks": describe_checks,
    }


def methods_values(context: ReportContext) -> Values | None:
    """Give the parameters that the methods text is made of; None where nothing was tested."""
    if not context.run.pipelines:
        return None
    weights = context.run.parameters.attention.weights.model_dump()
    sizes = Counter(key.split("/")[0] for key in context.run.tested_objects).values()
    return {
        "table": context.run.pipelines[0],
        "protocol": settled_protocol(list(sizes), context.run.parameters.recognition.protocol),
        "objects": len(context.run.objects),
        "classes": context.run.classes,
        "pipelines": _pipeline_texts(context.run),
        "elevations": [
            f"{value:g}" for value in context.run.parameters.viewpoints.elevations_degrees
        ],
        "weighted": [
            name if weight == 1.0 else f"{name} (weight {weight:g})"
            for name, weight in weights.items()
            if weight > 0
        ],
    }


def parameters_values(context: ReportContext) -> Values:
    """Give every parameter of the results, section by section, with what it means."""
    model = context.run.parameters
    return {
        "groups": [
            (name, list(_flattened(getattr(model, name), name)))
            for name in type(model).model_fields
            # No result depends on how work is divided; plug-ins have a sentence of their own.
            if name not in {"seed", "workflow", "plugins"}
        ],
        "plug_ins": [one.package or Path(one.source).name for one in loaded()],
        "seed": model.seed,
    }


def provenance_values(context: ReportContext) -> Values:
    """Give versions, commit, machine, and seconds a phase."""
    return {
        "versions": find_versions(),
        "commit": find_commit(),
        "key": context.run.files.key,
        "machine": describe_machine(),
        "seconds": context.seconds,
    }


def glossary_values(_: ReportContext) -> Values:
    """Give the words that are explained where one points at them, for those who can't point."""
    return {"words": WORDS}


def credits_values(context: ReportContext) -> Values:
    """Give the credit of every object's model."""
    return {
        "rows": [(key, context.run.credits.get(key)) for key in context.run.objects],
    }


def _scene_strips(run: Run, page: ObjectPage) -> Mapping[str, str]:
    """Touch the places of one view of an object in every scene; none without its mesh."""
    key = f"{page.category}/{page.name}"
    locations = select(
        run.fixations,
        **{"class": page.category},
        object=page.name,
        viewpoint=page.shown.viewpoint,
        strategy="fixation",
    )
    if key not in run.meshes or not locations.num_rows:
        return {}
    return scene_strips(run.meshes[key], locations, run.parameters)


def _flattened(model: Any, path: str) -> list[tuple[str, str, str]]:
    rows: list[tuple[str, str, str]] = []
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if hasattr(type(value), "model_fields"):
            rows += _flattened(value, f"{path}.{name}")
        else:
            rows.append((f"{path}.{name}", _written(value), field.description or ""))
    return rows


def _written(value: object) -> str:
    if isinstance(value, tuple | list):
        return ", ".join(_written(item) for item in value)
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}" if isinstance(value, float) else str(value)
