"""The few figures that a table of many experiments has room for: `reports/headline.json`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from visuohaptic.evaluation.published import PAPER_PIPELINE
from visuohaptic.parameters import CostParameters
from visuohaptic.report.cost import on_robot, reference_row
from visuohaptic.report.questions import MAIN_OPPONENT
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.studies.cost.cost_rows import Row, read_costs


def write_headline(
    metrics: str | Path, frontier: str | Path, cost: CostParameters, output: str | Path
) -> None:
    """Write the headline figures as JSON, from ``reports/metrics.json`` and the frontier's `tables.COST`."""
    summary = json.loads(Path(metrics).read_text(encoding="utf-8"))
    figures = headline_of(summary, read_costs(frontier), cost)
    Path(output).write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


def headline_of(
    summary: Mapping[str, Any], rows: Sequence[Row], cost: CostParameters
) -> dict[str, float]:
    """Return accuracies in per cent, and the seconds of one recognition from one view.

    Parameters
    ----------
    summary : mapping
        As `evaluation.summary.summarise` returns it.
    rows : sequence of mappings
        The frontier, `tables.COST`; without a timed row of the run's own setting there are no seconds.
    cost : CostParameters
        With the seconds that a robot takes for a touch and for a look.

    Returns
    -------
    dict
        Accuracies of the paper's pipeline by strategy (``fixation``), of others with their name
        (``order_free_fixation``); ``lead`` of fixation over random probing in the paper's pipeline and
        ``lead_draw_sd``, its standard deviation over draws, in percentage points, where places were drawn several
        times; ``robot_s``, with the time of touches and looks; ``cpu_s``, computing only.
    """
    found: dict[str, float] = {}
    results = summary["results"]
    for pipeline in sorted(results, key=PAPER_PIPELINE.__ne__):
        prefix = "" if pipeline == PAPER_PIPELINE else f"{pipeline}_"
        for strategy, classifiers in results[pipeline].items():
            headline = HEADLINE_CLASSIFIERS.get(pipeline)
            chosen = headline if headline in classifiers else next(iter(classifiers))
            found[f"{prefix}{strategy}"] = round(100 * classifiers[chosen]["accuracy"]["mean"], 2)
    compared = summary.get("comparisons", {}).get(PAPER_PIPELINE, {})
    lead = compared.get(HEADLINE_CLASSIFIERS[PAPER_PIPELINE], {}).get(MAIN_OPPONENT, {})
    if "draws" in lead:
        found["lead"] = round(100 * lead["difference"]["mean"], 2)
        found["lead_draw_sd"] = round(100 * lead["draws"]["standard_deviation"], 2)
    own = reference_row(rows)
    if own is not None and own["seconds"] is not None:
        found["robot_s"] = round(on_robot([own], cost)[0]["seconds"], 2)
        found["cpu_s"] = round(own["seconds"], 3)
    return found
