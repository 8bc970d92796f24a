"""One reading by itself, file to file."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

from readings.figures import reading_figures
from readings.tables import READINGS
from visuohaptic.studies.measuring import make_study_block
from visuohaptic.studies.study import Given
from visuohaptic.whole_files import write_whole


def make_reading(given: Given) -> None:
    """Measure one reading as the whole study does, and write its rows of `READINGS`, without seconds, as JSON.

    Numbers have all their digits.
    """
    run = given.run
    with tempfile.TemporaryDirectory() as folder:
        block = Path(folder, "reading.parquet")
        make_study_block(
            given.study, [given.condition or {}], given.inputs["features"], given.made, block, run
        )
        table = reading_figures([block], run.recognition.intervals, run.seed)
    ordered = table.sort_by([(key, "ascending") for key in READINGS.keys])
    rows = ordered.drop_columns("seconds").to_pylist()
    write_whole(given.outputs[0], json.dumps(rows, indent=2, ensure_ascii=False) + "\n")
