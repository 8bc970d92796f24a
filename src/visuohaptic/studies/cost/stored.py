"""A frontier that was measured on many objects and is kept with the package, as it takes long to measure.

`frontier_large.json` beside this file, where it was measured, holds its rows with the machine, the date and the command;
`python -m visuohaptic.studies.cost.stored results/frontier.parquet COMMAND PROCESSOR` writes it again.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path

from visuohaptic.recognition.metrics import round_numbers
from visuohaptic.studies.cost.front import read_costs
from visuohaptic.studies.cost.pairs import Row

NAME = "frontier_large.json"


@dataclass(frozen=True)
class StoredFrontier:
    """A frontier with where it comes from.

    Attributes
    ----------
    rows : list of dict
        Rows of `tables.COST`.
    objects : int
        Objects that were tested.
    machine, date, command, version : str
        Processor, day of the measurement (UTC), what was run, and the package's version.
    """

    rows: list[Row]
    objects: int
    machine: str
    date: str
    command: str
    version: str


def stored_frontier() -> StoredFrontier | None:
    """Read the frontier that is kept with the package; None where there is none."""
    file = files("visuohaptic.studies.cost").joinpath(NAME)
    if not file.is_file():
        return None
    return StoredFrontier(**json.loads(file.read_text("utf-8")))


def store_frontier(table: str | Path, output: str | Path, command: str, machine: str) -> None:
    """Write a measured frontier with where it comes from.

    Parameters
    ----------
    table : path
        `tables.COST`.
    output : path
        The JSON file.
    command : str
        What was run to measure it.
    machine : str
        The processor that it was measured on.
    """
    import visuohaptic

    rows = read_costs(table)
    values = {
        "objects": max(row["objects"] or 0 for row in rows),
        "machine": machine,
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "command": command,
        "version": visuohaptic.__version__,
        "rows": [round_numbers(row) for row in rows],
    }
    Path(output).write_text(json.dumps(values, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    store_frontier(sys.argv[1], Path(__file__).with_name(NAME), sys.argv[2], sys.argv[3])
