"""The headline figures of a run for tables of many experiments: `reports/headline.json`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.evaluation.published import PAPER_PIPELINE
from visuohaptic.parameters import CostParameters
from visuohaptic.report.cost import on_robot, reference_row
from visuohaptic.report.questions import MAIN_OPPONENT
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.studies.cost.cost_rows import Row, read_costs


def write_headline(
    metrics: str | Path, frontier: str | Path, cost: CostParameters, output: str | Path
) -> None:
    """Write the headline figures as JSON.

    `metrics` is ``reports/metrics.json``, and `frontier` a file of `tables.COST`.
    """
    summary = json.loads(Path(metrics).read_text(encoding="utf-8"))
    figures = headline_of(summary, read_costs(frontier), cost)
    atomic_write_text(output, json.dumps(figures, indent=2) + "\n")


def headline_of(
    summary: Mapping[str, Any], rows: Sequence[Row], cost: CostParameters
) -> dict[str, float]:
    """Compute accuracies in per cent, and the seconds of one recognition from one view.

    Parameters
    ----------
    summary : mapping
        The result of `evaluation.summary.summarise`.
    rows : sequence of mappings
        Rows of `tables.COST`. Without a timed row of the run's own setting the result has no seconds.
    cost : CostParameters
        The seconds that a robot takes per touch and per look.

    Returns
    -------
    dict
        The accuracies: of the paper's pipeline by strategy (``fixation``), of other pipelines with their name in front
        (``order_free_fixation``). ``lead`` is the lead of fixation over random probing in the paper's pipeline, in
        percentage points, and ``lead_draw_sd`` its standard deviation over draws. Both are missing if random places
        were drawn only once. ``robot_s`` are seconds with a robot's touches and looks, ``cpu_s`` of computing only.
    """
    figures: dict[str, float] = {}
    results = summary["results"]
    for pipeline in sorted(results, key=PAPER_PIPELINE.__ne__):
        prefix = "" if pipeline == PAPER_PIPELINE else f"{pipeline}_"
        for strategy, classifiers in results[pipeline].items():
            headline = HEADLINE_CLASSIFIERS.get(pipeline)
            chosen = headline if headline in classifiers else next(iter(classifiers))
            figures[f"{prefix}{strategy}"] = round(100 * classifiers[chosen]["accuracy"]["mean"], 2)
    compared = summary.get("comparisons", {}).get(PAPER_PIPELINE, {})
    lead = compared.get(HEADLINE_CLASSIFIERS[PAPER_PIPELINE], {}).get(MAIN_OPPONENT, {})
    if "draws" in lead:
        figures["lead"] = round(100 * lead["difference"]["mean"], 2)
        figures["lead_draw_sd"] = round(100 * lead["draws"]["standard_deviation"], 2)
    reference = reference_row(rows)
    if reference is not None and reference["seconds"] is not None:
        figures["robot_s"] = round(on_robot([reference], cost)[0]["seconds"], 2)
        figures["cpu_s"] = round(reference["seconds"], 3)
    return figures
