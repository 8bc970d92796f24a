"""The phases of one object in memory, with the same functions as the workflow's jobs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import pyarrow as pa

from visuohaptic.features.describing import describe
from visuohaptic.fixations.object_views import ObjectViews
from visuohaptic.geometry.subject import Subject
from visuohaptic.io.phase_files import Tables, Work, check_arguments
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import PHASES, Phase, phases_after
from visuohaptic.touches.acquiring import acquire_touches

VIEWPOINTS_AT_ONCE = 8
"""Most viewpoints per block; the number changes no result."""

WORK: Mapping[str, Work] = {
    "fixations": ObjectViews,
    "touches": acquire_touches,
    "features": describe,
}
"""The functions of the phases in `phases.OF_OBJECT`, by name of the phase.

``work(subject, *input_tables, **arguments)`` returns an object with one attribute per output table.
"""

_READ = {name for phase in PHASES for name in phase.inputs}


def run(subject: Subject, parameters: ExperimentParameters, tables: Tables | None = None) -> Tables:
    """Run the phases of one object in memory; the results equal the results of the workflow.

    `tables` has existing results by name: only the phases after the last of these results run. The returned mapping has
    `tables`, ``features``, and all new tables that a later phase reads.
    """
    if tables:
        return _run_remaining(subject, parameters, tables)
    parts = [_run_remaining(block, parameters, {}) for block in blocks_of(subject, parameters)]
    return {name: pa.concat_tables(part[name] for part in parts) for name in parts[0]}


def blocks_of(subject: Subject, parameters: ExperimentParameters) -> Iterator[Subject]:
    """Yield subjects with as many of the viewpoints as are held in memory together."""
    return subject.blocks(min(VIEWPOINTS_AT_ONCE, parameters.rendering.views_at_once))


def touch_all_locations(
    parameters: ExperimentParameters, fixations: pa.Table
) -> ExperimentParameters:
    """Return parameters with which the sensor touches all rows of a table of probing locations, also out of reach."""
    attention = parameters.attention.model_copy(update={"fixations": fixations.num_rows})
    probing = parameters.probing.model_copy(
        update={"unreachable": "keep", "when_exhausted": "stop"}
    )
    return parameters.model_copy(update={"attention": attention, "probing": probing})


def _run_remaining(subject: Subject, parameters: ExperimentParameters, tables: Tables) -> Tables:
    results = dict(tables)
    for step in phases_after(tables):
        results |= tables_for_next(step, run_phase(step, subject, results, parameters))
    return results


def tables_for_next(phase: Phase, outputs: Any) -> Tables:
    """Return the output tables of a phase that any phase reads, by name."""
    return {name: getattr(outputs, name) for name in phase.writes if name in _READ}


def run_phase(
    phase: Phase, subject: Subject, tables: Tables, parameters: ExperimentParameters
) -> Any:
    """Run a phase for one object and return an object with one attribute per output table."""
    work = WORK[phase.name]
    arguments = check_arguments(work, phase.values(parameters))
    return work(subject, *(tables[name] for name in phase.input_tables), **arguments)
