"""The values of each section's template, from the tables of the run; None where it has nothing for the section."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from visuohaptic.attention.levels import CENTRE_LEVELS, SURROUND_OFFSETS
from visuohaptic.evaluation.intervals import EXTRA
from visuohaptic.evaluation.summary import confusion, select
from visuohaptic.fixations.viewpoints import FIELD_OF_VIEW_DEGREES
from visuohaptic.io.plugins import loaded
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import IntervalParameters, Protocol
from visuohaptic.report.comparison import PIPELINES, PipelineTable, draws_sentence, gain_sentence
from visuohaptic.report.cost import cost_answer, cue_sentences, robot_front, robot_price
from visuohaptic.report.draws import kept_sentence, read_draws
from visuohaptic.report.effects import (
    count_missing,
    count_passed_over,
    count_states,
    effects_answer,
    hard_places,
    replaced_sentence,
    rows_of_scenes,
    scene_strips,
    sum_channels,
    sum_effects,
)
from visuohaptic.report.estimates import Row
from visuohaptic.report.evaluation import odd_sentence
from visuohaptic.report.gaze import gaze_sentence
from visuohaptic.report.provenance import describe_machine, find_commit, find_versions
from visuohaptic.report.questions import (
    MAIN_OPPONENT,
    Answer,
    fixation_answer,
    has_opponent,
    recognition_answer,
    reproduction_answer,
    variant_sentences,
    variants_sentence,
)
from visuohaptic.report.run import Run
from visuohaptic.report.section import ReportContext, Values, files_of_rows, place_of
from visuohaptic.report.stability import (
    describe_checks,
    describe_hard_cases,
    read_hard_cases,
    stability_answer,
)
from visuohaptic.report.studies import names_of_own_studies, read_study
from visuohaptic.report.turned import (
    FRAMES_OF_POSES,
    KNOWN,
    POSES,
    frame_rows,
    more_objects_sentences,
    read_turned,
    turned_rows,
    turned_sentence,
    unknown_pose_sentence,
)
from visuohaptic.report.variants import VariantsSummary
from visuohaptic.report.wording import CONTACT_STATES, percent, spaced, strategy_name, titled
from visuohaptic.scene.parameters import PRESETS, VISUAL_EFFECTS
from visuohaptic.sensor.placing import PENETRATION_TOLERANCE
from visuohaptic.tables.phases import CONTOURLET_FEATURES
from visuohaptic.tables.schema import matrix

UNSEEN: Mapping[Protocol, str] = {
    "auto": "unseen objects",
    "leave_one_object_a_class_out": "unseen objects",
    "grouped_folds": "unseen objects",
    "new_viewpoint": "known objects from unseen viewpoints",
}
"""What is new to the classifier in a test, by protocol."""

NO_TOUCH = {
    "passed over": "no touch: a place that the sensor can't reach, before one that was touched instead",
    "missing": "no touch: the view has no further place in reach",
}


# Lines of Python with which a reader counts a headline number again, from the run's own tables.
_SHARES = """\
import pandas as pd
rows = pd.read_parquet({place!r})
rows = rows[(rows["pipeline"] == {pipeline!r}) & (rows["classifier"] == {classifier!r})]
right = (rows["predicted"] == rows["class"]).groupby([rows["strategy"], rows["split"], rows["seed"]])
shares = right.mean().groupby("strategy").mean()
print({shown})"""
_LEAD = """\
import pandas as pd
rows = pd.read_parquet({place!r}).rename(columns={{"seed": "repeat"}})
rows = rows.assign(accuracy=rows["predicted"] == rows["class"], sequences=1)
{further}rows = rows[(rows["pipeline"] == {pipeline!r}) & (rows["classifier"] == {classifier!r})]
share = rows["sequences"] / rows.groupby(["strategy", "split", "repeat"])["sequences"].transform("sum")
sums = rows.assign(right=share * rows["accuracy"], weight=share).groupby(["class", "object", "strategy"])
right, weight = (sums[name].sum().unstack() for name in ("right", "weight"))
shares = right / weight
lead = (shares[{first!r}] - shares.filter(regex="^{second}(#|$)").mean(axis=1)).dropna()
weight = weight.loc[lead.index, {first!r}]
print(f"{{100 * (lead * weight).sum() / weight.sum():+.1f}} points")"""
_FURTHER = "rows = pd.concat([rows, pd.read_parquet({place!r})])\n"
_COST = """\
import pandas as pd
rows = pd.read_parquet({place!r})
row = rows[(rows["family"] == {family!r}) & (rows["setting"] == {setting!r})].iloc[0]
print(f"{{row['seconds'] + {price:g}:.2f}} s, error rate {{100 * row['error']:.1f}} %")"""


def recount_shares(run: Run, table: PipelineTable, shown: str) -> str:
    """Give the lines that print `shown`, of the ``shares`` that the answers' classifier gets right by strategy."""
    place = place_of(run, files_of_rows(run.parts("predictions"), {"pipeline": table.name}))
    return _SHARES.format(
        place=place.as_posix(), pipeline=table.name, classifier=table.headline.key, shown=shown
    )


def recount_lead(run: Run, table: PipelineTable) -> str:
    """Return the lines that print the lead of the answers' classifier over random touches, from all draws."""
    place = place_of(run, files_of_rows(run.parts("predictions"), {"pipeline": table.name}))
    compared = table.headline.comparisons.get(MAIN_OPPONENT)
    drawn = run.parts("drawn") if compared and compared.draws else []
    return _LEAD.format(
        place=place.as_posix(),
        further=_FURTHER.format(place=place_of(run, drawn).as_posix()) if drawn else "",
        pipeline=table.name,
        classifier=table.headline.key,
        first=table.leading,
        second=MAIN_OPPONENT,
    )


def recount_cost(run: Run, row: Row) -> str:
    """Return the lines that print the seconds by a robot's clock and the error rate of a setting of this run."""
    place = place_of(run, run.parts("frontier")).as_posix()
    price = robot_price(row, run.parameters.cost)
    return _COST.format(place=place, family=row["family"], setting=row["setting"], price=price)


def values_or_none(**values: object) -> Values | None:
    """Give a section's values, or None where one of them is missing or empty."""
    return values if all(values.values()) else None


def answer_values(context: ReportContext) -> Values:
    """Give the answers to the experiment's questions, each with the lines that count its number again."""
    found = context.run.stability
    return {
        "answers": [
            replace(answer, recount=lines if answer.number else "")
            for answer, lines in _answers(context)
            if answer is not None
        ],
        "untested": not context.run.pipelines,
        "turned": kept_turned(context.run),
        "frontier": context.frontier,
        "confidence": percent(context.run.parameters.recognition.intervals.confidence, 0),
        "effects": effects_answer(context.influence["scenes"]) if context.influence else None,
        "stability": stability_answer(found) if found else None,
    }


def kept_leads(variants: VariantsSummary, intervals: IntervalParameters) -> list[str]:
    """Say how far fixation leads on more objects than a run has, from kept measurements.

    The sentences are of the largest set of `turned.json` upright, of the kept variants of the paper, and of the
    largest set turned.
    """
    kept = read_turned()
    if not kept:
        return variant_sentences(variants)
    largest = max(kept, key=lambda name: len(kept[name].objects))
    drawn = [found for name in PIPELINES if (found := read_draws(largest, name))]
    return [
        *more_objects_sentences(kept[largest], intervals, drawn),
        *variant_sentences(variants),
        turned_sentence(kept[largest], intervals),
        unknown_pose_sentence(kept[largest], intervals),
    ]


def kept_turned(run: Run) -> Values | None:
    """Return the kept table of turned objects of the run's set; None where none are kept."""
    kept = read_turned().get(run.parameters.meshes.set)
    if kept is None:
        return None
    rows = turned_rows(kept, run.parameters.recognition.intervals)
    poses = {
        pose: {row.pipeline: row for row in rows if row.turns == turns}
        for turns, pose in POSES.items()
    }
    shown = [{"pose": titled(pose), "by": found} for pose, found in poses.items() if found]
    by_frame = {
        (row.turns, row.known): row
        for row in frame_rows(kept, run.parameters.recognition.intervals)
    }
    frames = [
        {"known": titled(KNOWN[name[1]]), "row": by_frame[name]}
        for name in FRAMES_OF_POSES
        if name in by_frame
    ]
    return values_or_none(
        rows=shown,
        frames=frames,
        reporting=int(kept.reports.sum()),
        pipelines=list(dict.fromkeys(row.pipeline for row in rows)),
        date=kept.date,
        objects=max((row.objects for row in rows), default=0),
        draws=max((row.draws for row in rows), default=0),
    )


def _answers(context: ReportContext) -> Iterator[tuple[Answer | None, str]]:
    run, recognition = context.run, context.run.parameters.recognition
    if run.pipelines:
        first, fixations = run.pipelines[0], run.parameters.attention.fixations
        touches = min(recognition.touches or fixations, fixations)
        unseen = UNSEEN[recognition.protocol.protocol]
        accuracy = recount_shares(run, first, f'f"{{100 * shares[{first.leading!r}]:.1f}} %"')
        compared = next((table for table in run.pipelines if has_opponent(table)), first)
        odd = [sentence for sentence in (odd_sentence(context.evaluation),) if sentence]
        yield (
            recognition_answer(
                run.pipelines, len(run.classes), touches, unseen, run.parameters.meshes.turns, odd
            ),
            accuracy,
        )
        beside = kept_leads(context.variants, recognition.intervals)
        lead = recount_lead(run, compared)
        yield fixation_answer(run.pipelines, context.variants, beside), lead
        yield reproduction_answer(first), accuracy
    rows = context.frontier["rows"] if context.frontier else []
    for quickest in robot_front(rows, run.parameters.cost)[:1]:
        yield cost_answer(rows, run.parameters.cost), recount_cost(run, quickest)


def method_values(context: ReportContext) -> Values:
    """Give one real sequence, from the view to the answer."""
    page = context.explaining
    shown = select(context.run.features, **page.shown_rows, touch=0)
    return {
        "page": page,
        "bands": matrix(shown, CONTOURLET_FEATURES)[0].tolist() if shown.num_rows else [],
        "pipelines_text": " ".join(_pipeline_texts(context.run)),
        "gaze": gaze_sentence(context.run.files.gaze),
        "replaced": replaced_sentence(
            context.run.touches, context.run.parameters.attention.fixations
        ),
    }


def _pipeline_texts(run: Run) -> list[str]:
    """Say what each pipeline of the run is, and why."""
    return [PIPELINES[table.name] for table in run.pipelines if table.name in PIPELINES]


def comparison_values(context: ReportContext) -> Values | None:
    """Give the table of classifiers, beside the published one where it is comparable."""
    run = context.run
    if not run.pipelines:
        return None
    first, *others = map(strategy_name, run.pipelines[0].strategies)
    against = others[0] if len(others) == 1 else f"{len(others)} other strategies"
    sentences = (
        gain_sentence(run.pipelines[0]),
        draws_sentence(run.pipelines[0]),
        *_kept_draws(run),
        variants_sentence(context.variants),
        *(cue_sentences(context.frontier["rows"]) if context.frontier else ()),
    )
    return {
        "title": titled(f"{first} against {against}" if others else first),
        "sentences": [sentence for sentence in sentences if sentence],
        "tables": run.pipelines,
        "metrics": run.metrics,
    }


def _kept_draws(run: Run) -> Iterator[str]:
    """Say what kept draws of the run's set tell of pipelines that have one draw in the run."""
    for table in run.pipelines:
        compared = table.headline.comparisons.get(MAIN_OPPONENT)
        kept = read_draws(run.parameters.meshes.set, table.name)
        if kept is not None and compared is not None and compared.draws is None:
            yield kept_sentence(kept)


def evaluation_values(context: ReportContext) -> Values:
    """Return what a model answers for objects that it has not learnt, of this run or as kept with the package."""
    return {"evaluation": context.evaluation}


def own_studies_values(context: ReportContext) -> Values | None:
    """Give the studies that bring no section of their own."""
    folder = context.run.file_of("studies")
    studies = [read_study(folder, name) for name in names_of_own_studies(context.run)]
    return values_or_none(studies=[study for study in studies if study])


def cost_values(context: ReportContext) -> Values | None:
    """Give what accuracy costs in time in this run."""
    if context.run.file_of("frontier") is None:
        return None
    return {"frontier": context.frontier, "objects": len(context.run.objects)}


def effects_values(context: ReportContext) -> Values:
    """Give what was simulated and computed, and what was not needed."""
    effects, preset = sum_effects(context.run.effects), context.run.parameters.scene.preset
    seen = [row for row in effects if row["effect"] in VISUAL_EFFECTS]
    felt = [row for row in effects if row["effect"] not in VISUAL_EFFECTS]
    return {
        "groups": [
            ("Effects of the view", "views", seen),
            (f"Effects of touch in the scene {preset}", "touches", felt),
        ],
        "channels": sum_channels(context.run.views),
    }


def influence_values(context: ReportContext) -> Values:
    """Give hard places, and what effects cost and change where that was measured."""
    run, page = context.run, context.explaining
    accuracy = read_study(run.file_of("studies"), "effects", spaced)
    locations = select(run.fixations, **page.shown_rows)
    mesh = run.meshes.get(page.key) if locations.num_rows else None
    return {
        "page": page,
        "strips": scene_strips(mesh, locations, run.parameters) if mesh else {},
        "places": hard_places(run.parameters),
        "influence": context.influence,
        "answer": effects_answer(context.influence["scenes"]) if context.influence else "",
        "accuracy": accuracy,
        "by_scene": rows_of_scenes(accuracy) if accuracy else [],
        "chance": 1 / max(len(run.classes), 1),
        "scenes": list(PRESETS),
    }


def stability_values(context: ReportContext) -> Values | None:
    """Return how exact numbers are: on this run's objects, and in the hard cases of the code."""
    found, totals = context.run.stability, context.run.file_of("hard_cases")
    if found is None and totals is None:
        return None
    return {
        "found": found,
        "shares": "; ".join(
            f"{name} {percent(max(check.share for check in checks), 1)}"
            for name, checks in (found.requirements.items() if found else ())
        ),
        "hard_cases": describe_hard_cases(read_hard_cases(totals)) if totals else "",
        "anchors": {page.key: page.anchor for page in context.pages},
        "describe_checks": describe_checks,
    }


def confusion_values(context: ReportContext) -> Values | None:
    """Give the confusion matrices, the best classifier first."""
    if not context.run.pipelines:
        return None
    run, table = context.run, context.run.pipelines[0]
    shares = table.headline.class_accuracy
    predicted = select(run.predictions, pipeline=table.name)
    rows = sorted(table.rows, key=lambda row: row is not table.headline)
    found = [
        (row, strategy, confusion(select(predicted, strategy=strategy, classifier=row.key)))
        for row in rows
        for strategy in table.strategies
        if strategy in row.accuracy
    ]
    return {
        "sentence": class_sentence(table),
        "best": [(row.name, *rest) for row, *rest in found if row is table.headline],
        "others": [(row.name, *rest) for row, *rest in found if row is not table.headline],
        "class_accuracy": [
            {"class": one, "by": {strategy: found.get(one) for strategy, found in shares.items()}}
            for one in run.classes
        ],
        "strategies": [name for name in table.strategies if name in shares],
    }


def class_sentence(table: PipelineTable) -> str:
    """Say which classes the best classifier finds most and least often."""
    shares = table.headline.class_accuracy.get(table.leading, {})
    if len(shares) < 2:
        return f"{titled(table.headline.name)}: one class alone can't be confused."
    ordered = sorted(shares, key=lambda name: -shares[name].mean)
    most, least = (f"{name} ({percent(shares[name].mean)})" for name in (ordered[0], ordered[-1]))
    return (
        f"Of the classes, the {table.headline.name} finds {most} most often, and {least} least often, "
        f"with {strategy_name(table.leading)}."
    )


def objects_values(context: ReportContext) -> Values:
    """Give every object, how often each kind of contact was met, and what was out of reach."""
    run = context.run
    states = count_states(run.touches)
    counts = {
        state: {name: found[state] for name, found in states.items()} for state in CONTACT_STATES
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
            {"state": one, "meaning": meanings[one], "counts": by} for one, by in counts.items()
        ],
        "objects": len(run.objects),
        "checks": {} if run.stability is None else run.stability.objects,
        "describe_checks": describe_checks,
    }


def methods_values(context: ReportContext) -> Values | None:
    """Return the parameters and constants of the methods text; None where nothing was tested."""
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
    """Give every parameter of the results, section by section, with what it means."""
    model: ExperimentParameters = context.run.parameters
    return {
        "groups": [
            (name, _flattened(getattr(model, name), name))
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
