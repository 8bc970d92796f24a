"""One reading by itself, file to file."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.files import make_study_block
from visuohaptic.studies.readings.design import NAME
from visuohaptic.studies.readings.figures import reading_figures
from visuohaptic.tables.studies import READINGS
from visuohaptic.whole_files import write_whole


def make_reading(
    condition: Mapping[str, Any],
    features: Sequence[str | Path],
    made: Mapping[str, str | Path],
    output: str | Path,
    run: ExperimentParameters,
) -> None:
    """Measure one reading as the whole study does, and write its rows of `tables.READINGS`, without seconds, as JSON.

    Numbers have all their digits.

    `condition`, `features` and `made` are as `make_study_block` takes them.
    """
    with tempfile.TemporaryDirectory() as folder:
        block = Path(folder, "reading.parquet")
        make_study_block(NAME, [condition], features, made, block, run)
        table = reading_figures([block], run.recognition.intervals, run.seed)
    ordered = table.sort_by([(key, "ascending") for key in READINGS.keys])
    rows = ordered.drop_columns("seconds").to_pylist()
    write_whole(output, json.dumps(rows, indent=2, ensure_ascii=False) + "\n")
