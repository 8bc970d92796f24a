"""Presets for the command line, derived from a measured line of settings by one rule.

The rule: of family ``viewpoints``, whose settings one trained model serves, for they differ in
the number of viewpoints alone,

- ``fast`` is the quickest on that family's own front;
- ``accurate`` is the last on it, the one with the least error rate;
- ``balanced`` is the quickest on it whose error rate is at most the geometric mean of the other
  two's, an error rate of 0 counting as half the least one above it.

``budgets.json`` beside this file holds the line as it was measured, and on which set;
`python -m visuohaptic.studies.cost.budgets results/cost.parquet "which set"` writes it again.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal, get_args

BudgetName = Literal["fast", "balanced", "accurate"]

_KEPT = ("setting", "viewpoints", "objects", "seconds", "error", "error_low", "error_high")

Row = dict[str, Any]


@cache
def budgets() -> dict[str, Row]:
    """Give the presets, the quickest first: settings as measured, with the ``viewpoints`` that vote."""
    held = files("visuohaptic.studies.cost").joinpath("budgets.json").read_text("utf-8")
    return choose_budgets(json.loads(held)["line"])


def choose_budgets(line: Sequence[Row]) -> dict[str, Row]:
    """Apply the rule to a family's settings that did not fail: presets, the quickest first."""
    import numpy as np

    from visuohaptic.studies.cost.front import mark_front

    front = [row for row in mark_front(line) if row["on_front"]]
    front.sort(key=lambda row: float(row["seconds"]))
    errors = np.array([row["error"] for row in front])
    errors = np.maximum(errors, errors[errors > 0].min(initial=1.0) / 2)
    middle = np.sqrt(errors[0] * errors[-1]) * (1 + 1e-9)
    chosen = (front[0], front[np.argmax(errors <= middle)], front[-1])
    return dict(zip(get_args(BudgetName), chosen, strict=True))


def write_budgets(cost: str | Path, output: str | Path, measured_on: str) -> None:
    """Write the line from `tables.COST` as JSON."""
    from visuohaptic.recognition.metrics import round_numbers
    from visuohaptic.studies.cost.front import read_costs

    line = [
        round_numbers({name: row[name] for name in _KEPT})
        for row in read_costs(cost)
        if row["family"] == "viewpoints" and row["failed"] is None
    ]
    text = json.dumps({"measured_on": measured_on, "line": line}, indent=2) + "\n"
    Path(output).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write_budgets(sys.argv[1], Path(__file__).with_name("budgets.json"), sys.argv[2])
