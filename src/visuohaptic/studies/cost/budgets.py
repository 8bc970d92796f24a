"""Presets for the command line, derived from a measured line of settings by one rule.

The rule: of family ``viewpoints``, whose settings one trained model serves, for they differ in
the number of viewpoints alone,

- ``fast`` is the quickest on that family's own front;
- ``accurate`` is the last on it, the one with the least error rate;
- ``balanced`` is the quickest on it whose error rate is at most the geometric mean of the other
  two's, an error rate of 0 counting as half the least one above it.

``budgets.json`` beside this file holds the line as it was measured, on which set, and what the rule
makes of it; `python -m visuohaptic.studies.cost.budgets results/cost.parquet` writes it again.
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
BUDGETS: tuple[BudgetName, ...] = get_args(BudgetName)

FAMILY = "viewpoints"
_KEPT = ("setting", "viewpoints", "objects", "seconds", "error", "error_low", "error_high")

Row = dict[str, Any]


@cache
def budgets() -> dict[str, Row]:
    """Give the presets, the quickest first: ``viewpoints`` that vote, and ``seconds`` and ``error`` as measured."""
    held = json.loads(files("visuohaptic.studies.cost").joinpath("budgets.json").read_text("utf-8"))
    return {name: held["budgets"][name] for name in BUDGETS}


def choose_budgets(line: Sequence[Row]) -> dict[str, Row]:
    """Apply the rule to a family's settings that did not fail: presets, the quickest first."""
    import numpy as np

    from visuohaptic.studies.cost.front import mark_front

    line = sorted(line, key=lambda row: float(row["seconds"]))
    front = [row for row in mark_front(line) if row["on_front"]]
    errors = np.array([row["error"] for row in front])
    errors = np.maximum(errors, errors[errors > 0].min(initial=1.0) / 2)
    middle = np.sqrt(errors[0] * errors[-1]) * (1 + 1e-9)
    chosen = (front[0], front[np.argmax(errors <= middle)], front[-1])
    return {
        name: {key: row[key] for key in ("viewpoints", "seconds", "error")}
        for name, row in zip(BUDGETS, chosen, strict=True)
    }


def write_budgets(cost: str | Path, output: str | Path, measured_on: str) -> None:
    """Derive the presets from `tables.COST`, and write them with what they come from as JSON."""
    from visuohaptic.recognition.metrics import round_numbers
    from visuohaptic.studies.cost.front import read_costs

    line = [
        round_numbers({name: row[name] for name in _KEPT})
        for row in read_costs(cost)
        if row["family"] == FAMILY and row["failed"] is None
    ]
    values = {"measured_on": measured_on, "line": line, "budgets": choose_budgets(line)}
    Path(output).write_text(json.dumps(values, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write_budgets(sys.argv[1], Path(__file__).with_name("budgets.json"), sys.argv[2])
