"""Accuracy against touches: curves with intervals, and in words which strategy wins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visuohaptic.recognition.intervals import holm
from visuohaptic.report.comparison import PAPER_PIPELINE, REFERENCE, SIGNIFICANCE
from visuohaptic.report.studies import read_figures
from visuohaptic.report.wording import (
    counted,
    listed,
    percent,
    points,
    probability,
    strategy_name,
    strategy_place,
)
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import TOUCHES_NEEDED

Row = Mapping[str, Any]


@dataclass(frozen=True)
class CurveFigures:
    """One pipeline's curves.

    Attributes
    ----------
    pipeline, classifier : str
        Of what.
    sentences : tuple of str
        Which strategy wins, and by how much.
    strategies : tuple of str
        In the order of their colours.
    rows : sequence of mapping
        Rows of `tables.TOUCHES_NEEDED` with ``adjusted_p``, the largest area first.
    curves : mapping of str to sequence of mapping
        Rows of `tables.STUDY_FIGURES` by strategy, with ``touches``.
    """

    pipeline: str
    classifier: str
    sentences: tuple[str, ...]
    strategies: tuple[str, ...]
    rows: Sequence[Row]
    curves: Mapping[str, Sequence[Row]]


def curve_figures(studies: str | Path | None, needed: str | Path | None) -> list[CurveFigures]:
    """Read the curves over touches, the paper's pipeline first; empty where nothing was measured.

    `studies` is the folder of `tables.STUDY_FIGURES`, `needed` the file of `tables.TOUCHES_NEEDED`.
    """
    points_of = [{**row, "touches": row["place"] + 1} for row in read_figures(studies, "curves")]
    if not points_of or needed is None or not Path(needed).is_file():
        return []
    rows_of = read_table(TOUCHES_NEEDED, needed).to_pylist()
    keys = sorted({(row["pipeline"], row["classifier"]) for row in rows_of})
    keys.sort(key=lambda key: key[0] != PAPER_PIPELINE)
    return [
        _figures(
            *key,
            [row for row in rows_of if (row["pipeline"], row["classifier"]) == key],
            [row for row in points_of if (row["pipeline"], row["classifier"]) == key],
        )
        for key in keys
    ]


def verdict(rows: Sequence[Row]) -> tuple[str, ...]:
    """Say in sentences which strategy wins, and whether attention does.

    The rows are those of `tables.TOUCHES_NEEDED` of one pipeline and classifier, with
    ``adjusted_p``.
    """
    ranked = sorted(rows, key=lambda row: -row["area"])
    best = ranked[0]
    most = best["most_touches"]
    first = (
        f"The largest area under the curve of 1 to {counted(most, 'touch')} is that of "
        f"{strategy_name(best['strategy'])}, {percent(best['area'])} of the area of perfect "
        f"classification."
    )
    return tuple(
        sentence
        for sentence in (first, _attention_sentence(ranked), _level_sentence(rows))
        if sentence
    )


def _figures(
    pipeline: str, classifier: str, rows: Sequence[Row], curve_points: Sequence[Row]
) -> CurveFigures:
    compared = [row for row in rows if row["p_value"] is not None]
    adjusted = holm([row["p_value"] for row in compared])
    of_strategy = {row["strategy"]: value for row, value in zip(compared, adjusted, strict=True)}
    full = [{**row, "adjusted_p": of_strategy.get(row["strategy"])} for row in rows]
    strategies = tuple(sorted((row["strategy"] for row in rows), key=strategy_place))
    curves = {
        strategy: sorted(
            (row for row in curve_points if row["strategy"] == strategy),
            key=lambda row: row["touches"],
        )
        for strategy in strategies
    }
    return CurveFigures(
        pipeline,
        classifier,
        verdict(full),
        strategies,
        sorted(full, key=lambda row: -row["area"]),
        curves,
    )


def _attention_sentence(ranked: Sequence[Row]) -> str:
    rank = next((place for place, row in enumerate(ranked, 1) if row["strategy"] == REFERENCE), 0)
    others = [row for row in ranked if row["gain"] is not None]
    if not rank or not others:
        return ""
    own = ranked[rank - 1]
    area = percent(own["area"])
    ahead = [row for row in others if row["gain"] < 0]
    if not ahead:
        text = (
            f"Attention wins: no other strategy's area is larger than that of eye fixations, {area}"
        )
    else:
        text = (
            f"Attention does not win: eye fixations, with {area}, are number {rank} of {len(ranked)}, "
            f"behind {listed([_gap(row) for row in ahead])}"
        )
    behind = [row for row in others if row["gain"] > 0]
    if behind:
        text += f"; they are ahead of {listed([_gap(row) for row in behind])}"
    settled = [row for row in others if row["adjusted_p"] < SIGNIFICANCE]
    objects = counted(own["objects"], "object")
    if not settled:
        least = probability(min(row["adjusted_p"] for row in others))
        return f"{text}. With {objects} none of these differences is beyond chance (smallest Holm-adjusted p {least})."
    names = listed([strategy_name(row["strategy"]) for row in settled])
    return (
        f"{text}. Beyond chance with {objects} (Holm-adjusted p below {SIGNIFICANCE:g}) is the "
        f"difference to {names}."
    )


def _gap(row: Row) -> str:
    return f"{strategy_name(row['strategy'])} ({points(row['gain'])} percentage points)"


def _level_sentence(rows: Sequence[Row]) -> str:
    level = percent(rows[0]["level"], 0)
    reached = [row for row in rows if row["touches"] is not None]
    if not reached:
        return f"None stays at {level} up to {counted(rows[0]['most_touches'], 'touch')}."
    fewest = min(row["touches"] for row in reached)
    winners = [strategy_name(row["strategy"]) for row in reached if row["touches"] == fewest]
    text = f"Fewest touches from which on accuracy stays at {level}: {fewest}, by {listed(winners)}"
    own = next((row for row in rows if row["strategy"] == REFERENCE), None)
    if own is None or own["touches"] == fewest:
        return f"{text}."
    need = "never get there" if own["touches"] is None else f"need {own['touches']}"
    return f"{text}; eye fixations {need}."
