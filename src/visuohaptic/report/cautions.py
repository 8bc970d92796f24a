"""Warnings about a run, one sentence each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from hashlib import file_digest
from pathlib import Path

from visuohaptic.report.provenance import PhaseSeconds
from visuohaptic.report.run import Run
from visuohaptic.report.stability import describe_checks
from visuohaptic.report.wording import counted, listed, listed_in_short
from visuohaptic.tables.phases import key_of

_TOO_FEW = "left out of recognition if it needs more touches"
_MOST_REASONS = 20
"""Left-out objects that are listed with their reason; further objects are only counted."""


def find_warnings(run: Run, seconds: Sequence[PhaseSeconds]) -> list[str]:
    """Return one sentence per thing that was left out, fell short or failed.

    `seconds` are the run times of the phases, with the logs of unfinished jobs.
    """
    unfinished = [log for phase in seconds for log in phase.unfinished]
    meshless = [key for key in run.objects if key not in run.meshes]
    no_mesh = f"No mesh was found of {listed_in_short(meshless)}, so no 3D model is shown."
    return [
        *_objects_left_out(run),
        *_notes_on_files(run),
        *_equal_surfaces(run),
        *_poor_views(run),
        *_short_sequences(run),
        *_unfitted_classifiers(run),
        *([no_mesh] if meshless else []),
        *_broken_checks(run),
        *_warned(unfinished, "job", "did not finish; the reason is in"),
    ]


def _warned(names: Sequence[str], noun: str, what: str, end: str = ".") -> list[str]:
    """Return a sentence that counts names, states `what` about the names, and lists some; empty without names."""
    return [f"{counted(len(names), noun)} {what} {listed_in_short(names)}{end}"] if names else []


def _objects_left_out(run: Run) -> Iterator[str]:
    unusable = sorted(run.set_aside)
    for key in unusable[:_MOST_REASONS]:
        yield f"{key} was left out: {run.set_aside[key]}"
    yield from _warned(unusable[_MOST_REASONS:], "more object", "left out:")
    untouched = sorted(set(run.all_objects) - set(run.objects) - set(run.set_aside))
    them = "it" if len(untouched) == 1 else "them"
    yield from _warned(untouched, "object", f"of the set left out, because no table holds {them}:")
    untested = sorted(set(run.objects) - set(run.tested_objects))
    classes = Counter(key.split("/")[0] for key in run.objects)
    yield from _warned(
        [key for key in untested if classes[key.split("/")[0]] == 1],
        "object",
        "touched, but not tested, because each is the only object of its class and recognition needs two:",
    )
    samples = run.parameters.recognition.protocol.protocol == "leave_one_object_a_class_out"
    yield from _warned(
        [key for key in untested if classes[key.split("/")[0]] > 1],
        "object",
        "touched, but never tested by recognition:",
        ". Protocol auto tests every object." if samples else ".",
    )


def _notes_on_files(run: Run) -> Iterator[str]:
    noted = sorted(run.notes)
    for key in noted[:_MOST_REASONS]:
        yield from (f"{key}: {note}" for note in run.notes[key])
    yield from _warned(noted[_MOST_REASONS:], "more object", "with notes on the model's file:")


def _equal_surfaces(run: Run) -> Iterator[str]:
    """Yield a sentence per group of objects with equal prepared meshes: training and test may share a surface."""
    by_size: dict[int, list[str]] = {}
    for key, path in run.meshes.items():
        by_size.setdefault(path.stat().st_size, []).append(key)
    for keys in by_size.values():
        by_content: dict[bytes, list[str]] = {}
        for key in keys if len(keys) > 1 else ():
            by_content.setdefault(_digest(run.meshes[key]), []).append(key)
        for equal in by_content.values():
            if len(equal) > 1:
                yield (
                    f"{listed(sorted(equal))} have the same surface, so accuracies are too high: an object can be "
                    "tested by a classifier that was trained on its own surface."
                )


def _digest(path: Path) -> bytes:
    with path.open("rb") as stream:
        return file_digest(stream, "sha256").digest()


def _views(run: Run) -> dict[tuple[str, int], int]:
    """Count the distinct fixations of each view, by object and viewpoint."""
    columns = ["class", "object", "viewpoint", "distinct_fixations"]
    rows = run.views.select(columns).to_pylist()
    return {(key_of(row), row["viewpoint"]): row["distinct_fixations"] for row in rows}


def _poor_views(run: Run) -> list[str]:
    required = run.parameters.attention.fixations
    poor = [view for view, distinct in _views(run).items() if distinct < required]
    owners: dict[str, list[str]] = {}
    for key, viewpoint in poor:
        owners.setdefault(key, []).append(str(viewpoint))
    named = [f"{key} (view {listed(views)})" for key, views in sorted(owners.items())]
    count = f"{counted(len(poor), 'view')} with fewer than {required} distinct fixations"
    return [f"{count}, {_TOO_FEW}: {listed_in_short(named)}."] if poor else []


def _short_sequences(run: Run) -> list[str]:
    """Return a sentence on sequences with too few places in reach of the sensor; empty without such sequences."""
    required = run.parameters.attention.fixations
    sequence = ["class", "object", "viewpoint", "strategy"]
    counts = run.touches.group_by(sequence).aggregate([([], "count_all")]).to_pylist()
    touches = {(key_of(row), row["viewpoint"], row["strategy"]): row["count_all"] for row in counts}
    short = [
        f"{key} (view {viewpoint}, {strategy})"
        for (key, viewpoint), distinct in sorted(_views(run).items())
        for strategy in sorted(run.parameters.probing.strategies)
        # Views that are poor in fixations have a warning of their own.
        if (strategy != "fixation" or distinct >= required)
        and touches.get((key, viewpoint, strategy), 0) < required
    ]
    return _warned(short, "sequence", f"with fewer than {required} places in reach, {_TOO_FEW}:")


def _unfitted_classifiers(run: Run) -> Iterator[str]:
    recognition = run.parameters.recognition
    for pipeline, strategies in run.metrics["results"].items():
        fitted = {name for classifiers in strategies.values() for name in classifiers}
        yield from _warned(
            [
                name.replace("_", " ")
                for name in recognition.classifiers_of(pipeline)
                if name not in fitted
            ],
            "classifier",
            f"of pipeline {pipeline} left out, because the training sequences don't allow a fit:",
        )


def _broken_checks(run: Run) -> Iterator[str]:
    stability = run.stability
    if stability is not None and stability.broken:
        yield f"{describe_checks(stability.checks)} See the section on numerical stability."
