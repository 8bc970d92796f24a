"""Summarise all variants for the report: the verdict, counts and sentences."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, get_args

from variants.choices import BEST_OF_PAPER, BY_NAME
from variants.design import is_literal
from variants.kept import OUTSIDE, PAPER_SET, MeasuredVariants, kept_variants
from variants.leads import count_after_holm, sum_up
from variants.page import variants_sentences
from variants.result import Changed, Lead, Spread, VariantsSummary
from variants.verdicts import lead_evidence, of_papers_question, verdict
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
    sets = {"paper": measured, **({"outside": outside} if outside else {})}
    tables = {name: of_set.rows for name, of_set in sets.items()}
    return VariantsSummary(
        verdict=verdict(lead_evidence(tables, BEST_OF_PAPER)),
        spread=tuple(spread for rows in tables.values() for spread in _spread(rows)),
        leads=tuple(lead for of_set in sets.values() for lead in _main_leads(of_set)),
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


def _main_leads(measured: MeasuredVariants) -> list[Lead]:
    """Return the leads of the default and of the most literal variant."""
    objects = max((row["objects"] or 0 for row in measured.rows), default=0)
    return [
        Lead(
            objects=objects,
            variant=evidence.variant,
            opponent=opponent,
            difference=evidence.difference,
            low=evidence.low,
            high=evidence.high,
            date=measured.source.date if measured.source else None,
        )
        for opponent in get_args(Lead.model_fields["opponent"].annotation)
        for evidence in lead_evidence({"": measured.rows}, BEST_OF_PAPER, opponent)
        if evidence.variant != "other"
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
