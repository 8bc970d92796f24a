"""Summarise all variants for the report: counts and sentences."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from variants.choices import BEST_OF_PAPER, BY_NAME
from variants.design import is_literal
from variants.kept import OUTSIDE, PAPER_SET, MeasuredVariants, kept_variants
from variants.leads import count_after_holm, sum_up
from variants.page import variants_sentences
from variants.result import Changed, Spread, VariantsSummary
from variants.verdicts import of_papers_question
from variants.weighing import summarise_variants, variant_figures
from visuohaptic.studies.figures import Row, write_json
from visuohaptic.studies.keeping import write_measured
from visuohaptic.studies.study import StepInputs

CHOSEN_AGAIN = Path(__file__).with_name("chosen_again.json")
"""The default that the rules of `choosing` give on later tables."""


def make_variants(step: StepInputs) -> None:
    """Write `VARIANTS` from the blocks of the study, and their summary as JSON."""
    output, summary = step.outputs
    table = variant_figures(step.inputs["blocks"], step.run.recognition.intervals)
    write_measured(table, step.run.meshes.set, output)
    measured = MeasuredVariants(table.to_pylist())
    report = summarise(measured, kept_variants(OUTSIDE)).model_dump(mode="json")
    write_json({**summarise_variants(measured.rows), "report": report}, summary)


@cache
def kept_summary() -> VariantsSummary:
    """Return the summary of the kept variants."""
    return summarise(kept_variants(PAPER_SET), kept_variants(OUTSIDE))


def summarise(measured: MeasuredVariants, outside: MeasuredVariants | None) -> VariantsSummary:
    """Return the summary of the variants on the paper's set, `measured`, and on objects outside of it."""
    tables = [of_set.rows for of_set in (measured, outside) if of_set]
    return VariantsSummary(
        spread=tuple(spread for rows in tables for spread in _spread(rows)),
        sentences=tuple(variants_sentences(measured, outside, BEST_OF_PAPER)),
        literal=_literal(measured.rows),
        changed=_changed(json.loads(CHOSEN_AGAIN.read_text(encoding="utf-8"))),
        source=measured.source,
    )


def _spread(rows: Sequence[Row]) -> list[Spread]:
    compared = of_papers_question(rows, BEST_OF_PAPER)
    if not compared:
        return []
    lead, objects = sum_up(compared), max(row["objects"] for row in compared)
    ahead, behind = count_after_holm(compared)
    return [
        Spread(
            objects=objects,
            variants=lead.cases,
            ahead=lead.ahead_singly,
            behind=lead.behind_singly,
            ahead_holm=ahead,
            behind_holm=behind,
        )
    ]


def _literal(rows: Sequence[Row]) -> dict[str, dict[str, float]]:
    literal = [row for row in rows if is_literal(row) and row["error"] is None]
    return {
        strategy: {row["classifier"]: row[strategy] for row in literal}
        for strategy in ("fixation", "random")
    }


def _changed(again: Mapping[str, Any]) -> tuple[Changed, ...]:
    """Return the choices in which the rules of `choosing`, applied again, differ from the default."""
    chosen = again["chosen"]["changed"] | {row["choice"]: row["chosen"] for row in again["options"]}
    return tuple(
        Changed(
            choice=BY_NAME[name].label.lower(),
            default=BY_NAME[name].default.replace("_", " "),
            today=option.replace("_", " "),
        )
        for name, option in chosen.items()
        if option != BY_NAME[name].default
    )
