"""From meshes to the table and the figures of study looking, file to file."""

from __future__ import annotations

from visuohaptic.errors import ParameterError
from visuohaptic.studies.figures import write_json
from visuohaptic.studies.looking.figures import sum_up_looking
from visuohaptic.studies.looking.measuring import measure_looking
from visuohaptic.studies.looking.sensing import sense_all, touches_of_run
from visuohaptic.studies.study import Given
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import LOOKING


def make_looking(given: Given) -> None:
    """Make `tables.LOOKING`, and its summary as JSON.

    Where strategy ``adaptive`` is compared, it takes a table of all places that it may touch. Raises
    `ParameterError` if a touch is free.
    """
    run, (table, metrics) = given.run, given.outputs
    if not run.cost.touch_seconds:
        raise ParameterError(
            "cost.touch_seconds is 0, so every touch is worth it; study looking needs more than 0."
        )
    tables = given.inputs.get("tables")
    candidates = read_table(FEATURES, tables) if tables else None
    sensed = sense_all(given.inputs["meshes"], candidates, run, given.processes)
    measured = measure_looking(sensed, run, given.processes)
    write_table(LOOKING, measured, table)
    intervals = run.recognition.intervals
    found = sum_up_looking(measured, run.cost, touches_of_run(run), intervals, run.seed)
    write_json(found, metrics)
