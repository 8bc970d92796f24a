"""From meshes to the table and the figures of study looking, file to file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from visuohaptic.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.figures import write_json
from visuohaptic.studies.looking.figures import sum_up_looking
from visuohaptic.studies.looking.measuring import measure_looking
from visuohaptic.studies.looking.sensing import sense_all, touches_of_run
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import LOOKING


def make_looking(
    meshes: Sequence[str | Path],
    candidates: str | Path | Sequence[str | Path],
    table: str | Path,
    metrics: str | Path,
    run: ExperimentParameters,
    processes: int = 1,
) -> None:
    """Make `tables.LOOKING`, and its summary as JSON.

    `candidates` are touches wherever strategy ``adaptive`` may choose to, as study `curves` makes
    them; none where it is not compared. The number of processes changes no result. Raises `ParameterError` if a touch is free.
    """
    if not run.cost.touch_seconds:
        raise ParameterError(
            "cost.touch_seconds is 0, so every touch is worth it; study looking needs more than 0."
        )
    sensed = sense_all(
        meshes, read_table(FEATURES, candidates) if candidates else None, run, processes
    )
    measured = measure_looking(sensed, run, processes)
    write_table(LOOKING, measured, table)
    intervals = run.recognition.intervals
    found = sum_up_looking(measured, run.cost, touches_of_run(run), intervals, run.seed)
    write_json(found, metrics)
