"""What a reader must know before trusting the page, each in one sentence."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from visuohaptic.guards.table import failed_guards
from visuohaptic.report.provenance import PhaseSeconds
from visuohaptic.report.run import Run
from visuohaptic.report.stability import describe_checks
from visuohaptic.report.wording import counted, listed, listed_in_short
from visuohaptic.tables.phases import key_of

_SECTION_OF_STUDY = {
    "ablations": "ablations",
    "certainty": "certainty",
    "cost": "cost",
    "curves": "touches_needed",
    "effects": "influence",
    "looking": "looking",
    "readings": "readings",
}

_MOST_REASONS = 20
"""Objects that were left out, each with its reason in a line of its own."""


def find_warnings(run: Run, seconds: list[PhaseSeconds]) -> list[str]:
    """List in sentences what was left out, fell short or failed."""
    return [
        *_failed_guards(run),
        *_objects_left_out(run),
        *_poor_views(run),
        *_short_sequences(run),
        *_unfitted_classifiers(run),
        *_missing_models(run),
        *_broken_tolerances(run),
        *(earlier_study(run, name) for name in sorted(run.files.earlier_studies)),
        *_failed_jobs(seconds),
    ]


def earlier_by_section(run: Run) -> dict[str, list[str]]:
    """Give the sentences about studies of an earlier state by the section that shows them.

    Parameters
    ----------
    run : Run
        The run.

    Returns
    -------
    dict of str to list of str
        By the section's name.
    """
    found: dict[str, list[str]] = {}
    for name in sorted(run.files.earlier_studies):
        section = _SECTION_OF_STUDY.get(name, "studies")
        found.setdefault(section, []).append(earlier_study(run, name))
    return found


def earlier_study(run: Run, name: str) -> str:
    """Say that a study does not belong to the state that the rest of the page shows."""
    return (
        f"Study {name} was measured with an earlier state of tables, parameters or code "
        f"({run.files.earlier_studies[name]}): snakemake -j2 study_{name} measures it again."
    )


def _objects_left_out(run: Run) -> list[str]:
    warnings = []
    reasons = [f"{key} was left out: {reason}" for key, reason in sorted(run.set_aside.items())]
    warnings += reasons[:_MOST_REASONS]
    if others := sorted(run.set_aside)[_MOST_REASONS:]:
        warnings.append(
            f"{counted(len(others), 'more object')} left out: {listed_in_short(others)}."
        )
    untouched = sorted(set(run.named_objects) - set(run.objects) - set(run.set_aside))
    if untouched:
        warnings.append(
            f"{counted(len(untouched), 'object')} of the set left out, for no table holds "
            f"{_them(untouched)}: {listed_in_short(untouched)}."
        )
    untested = sorted(set(run.objects) - set(run.tested_objects))
    classes = Counter(key.split("/")[0] for key in run.objects)
    alone = [key for key in untested if classes[key.split("/")[0]] == 1]
    if alone:
        warnings.append(
            f"{counted(len(alone), 'object')} touched, but not tested, for each is alone in its class "
            f"and recognition needs two objects of a class: {listed_in_short(alone)}."
        )
    untested = [key for key in untested if key not in alone]
    if untested:
        protocol = run.parameters.recognition.protocol.protocol
        samples = protocol == "leave_one_object_a_class_out"
        advice = " Protocol auto tests every object." if samples else ""
        warnings.append(
            f"{counted(len(untested), 'object')} touched, but never tested by recognition: "
            f"{listed_in_short(untested)}.{advice}"
        )
    return warnings


def _poor_views(run: Run) -> list[str]:
    asked = run.parameters.attention.fixations
    columns = run.views.select(["class", "object", "viewpoint", "distinct_fixations"])
    poor = [row for row in columns.to_pylist() if row["distinct_fixations"] < asked]
    if not poor:
        return []
    owners: dict[str, list[str]] = {}
    for row in poor:
        owners.setdefault(key_of(row), []).append(str(row["viewpoint"]))
    places = [f"{key} (view {listed(views)})" for key, views in sorted(owners.items())]
    found = f"{counted(len(poor), 'view')} with fewer than {asked} distinct fixations"
    return [
        f"{found}, which recognition leaves out where it needs more touches: {listed_in_short(places)}."
    ]


def _short_sequences(run: Run) -> list[str]:
    """Name objects of which the sensor reaches too little from some views."""
    asked = run.parameters.attention.fixations
    sequence = ["class", "object", "viewpoint", "strategy"]
    counts = run.touches.group_by(sequence).aggregate([([], "count_all")])
    views = run.views.select(["class", "object", "viewpoint", "distinct_fixations"]).to_pylist()
    enough = {
        (key_of(row), row["viewpoint"]) for row in views if row["distinct_fixations"] >= asked
    }
    made = {
        (key_of(row), row["viewpoint"], row["strategy"]): row["count_all"]
        for row in counts.to_pylist()
    }
    short = sorted(
        (key, viewpoint, strategy)
        for key, viewpoint in enough
        for strategy in run.parameters.probing.strategies
        if made.get((key, viewpoint, strategy), 0) < asked
    )
    if not short:
        return []
    places = [f"{key} (view {viewpoint}, {strategy})" for key, viewpoint, strategy in short]
    found = f"{counted(len(short), 'sequence')} with fewer than {asked} places in reach"
    return [
        f"{found}, which recognition leaves out where it needs more touches: {listed_in_short(places)}."
    ]


def _unfitted_classifiers(run: Run) -> list[str]:
    recognition = run.parameters.recognition
    asked = {"paper": recognition.classifiers, "best": recognition.best.classifiers}
    warnings = []
    for pipeline, strategies in run.metrics.get("results", {}).items():
        fitted = {name for classifiers in strategies.values() for name in classifiers}
        missing = [name.replace("_", " ") for name in asked.get(pipeline, ()) if name not in fitted]
        if missing:
            warnings.append(
                f"{counted(len(missing), 'classifier')} of pipeline {pipeline} left out, for the "
                f"training sequences at hand don't allow a fit: {listed_in_short(missing)}."
            )
    return warnings


def _missing_models(run: Run) -> list[str]:
    missing = [key for key in run.objects if key not in run.meshes]
    if not missing:
        return []
    return [f"No mesh was found of {listed_in_short(missing)}: no model to turn is shown there."]


def _failed_guards(run: Run) -> list[str]:
    path = run.files.extras.get("guards")
    if path is None or not Path(path).is_file():
        return []
    return [f"The figures can't be trusted. {sentence}" for sentence in failed_guards(path)]


def _broken_tolerances(run: Run) -> list[str]:
    if run.stability is None or not run.stability.broken:
        return []
    return [f"{describe_checks(run.stability.checks)} See the section on numerical stability."]


def _failed_jobs(seconds: list[PhaseSeconds]) -> list[str]:
    failed = [log for phase in seconds for log in phase.unfinished]
    if not failed:
        return []
    return [
        f"{counted(len(failed), 'job')} did not finish; the reason is in {listed_in_short(failed)}."
    ]


def _them(names: list[str]) -> str:
    return "it" if len(names) == 1 else "them"
