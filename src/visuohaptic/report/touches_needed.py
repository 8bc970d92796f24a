"""Accuracy against touches: curves with intervals, and in words which strategy wins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from visuohaptic.recognition.intervals import holm
from visuohaptic.report.comparison import PAPER_PIPELINE, REFERENCE, SIGNIFICANCE
from visuohaptic.report.estimates import Row
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


@dataclass(frozen=True)
class CurveFigures:
    """The curves of one pipeline and classifier: `points` are rows of `tables.STUDY_FIGURES`.

    `rows` are those of `tables.TOUCHES_NEEDED` with ``adjusted_p``, the largest area first.
    """

    pipeline: str
    classifier: str
    rows: list[Row]
    points: list[Row]

    @property
    def strategies(self) -> list[str]:
        """In the order of their colours."""
        return sorted((row["strategy"] for row in self.rows), key=strategy_place)

    @property
    def by_touches(self) -> list[Row]:
        """A row for each number of ``touches``, with the ``points`` of all strategies by name."""
        found: dict[int, dict[str, Row]] = {}
        for row in self.points:
            found.setdefault(row["place"] + 1, {})[row["strategy"]] = row
        return [{"touches": touches, "points": found[touches]} for touches in sorted(found)]

    @property
    def verdict(self) -> str:
        """Whether attention wins, in a sentence or two."""
        return verdict(self.rows)


def curve_figures(studies: str | Path | None, needed: str | Path | None) -> list[CurveFigures]:
    """Read the curves over touches, the paper's pipeline first; empty where nothing was measured."""
    points_of = read_figures(studies, "curves")
    if not points_of or needed is None or not Path(needed).is_file():
        return []
    rows_of = read_table(TOUCHES_NEEDED, needed).to_pylist()
    keys = sorted({_cell(row) for row in rows_of}, key=lambda key: (key[0] != PAPER_PIPELINE, key))
    return [
        CurveFigures(
            *key,
            _adjusted([row for row in rows_of if _cell(row) == key]),
            [row for row in points_of if _cell(row) == key],
        )
        for key in keys
    ]


def touches_needed(row: Row) -> Markup:
    """Write how many touches a strategy needs, with those that its intervals leave open."""
    most = row["most_touches"]
    found = Markup("{}").format(f"never up to {most}" if row["touches"] is None else row["touches"])
    if row["touches_low"] is None:
        return found
    high = f"more than {most}" if row["touches_high"] is None else row["touches_high"]
    return found + Markup('<span class="interval">{} to {}</span>').format(row["touches_low"], high)


def verdict(ranked: Sequence[Row]) -> str:
    """Say of rows of `CurveFigures` whether attention has the largest area, and what is beyond chance."""
    best = ranked[0]
    first = (
        f"The largest area under the curve of 1 to {counted(best['most_touches'], 'touch')} is that of "
        f"{strategy_name(best['strategy'])}, {percent(best['area'])} of the area of perfect classification"
    )
    others = [row for row in ranked if row["gain"] is not None]
    if not others:
        return f"{first}."
    ahead = [row for row in others if row["gain"] < 0]
    wins = "attention does not win" if ahead else "attention wins"
    gaps = listed([f"{strategy_name(row['strategy'])} {points(row['gain'])}" for row in others])
    settled = [strategy_name(row["strategy"]) for row in others if row["adjusted_p"] < SIGNIFICANCE]
    least = probability(min(row["adjusted_p"] for row in others))
    chance = (
        f"beyond chance is the difference to {listed(settled)} (Holm-adjusted p below {SIGNIFICANCE:g})"
        if settled
        else f"no difference is beyond chance (smallest Holm-adjusted p {least})"
    )
    return (
        f"{first}: {wins}. Percentage points by which {strategy_name(REFERENCE)} are ahead of others: "
        f"{gaps}; with {counted(others[0]['objects'], 'object')} {chance}."
    )


def _cell(row: Row) -> tuple[str, str]:
    return row["pipeline"], row["classifier"]


def _adjusted(rows: Sequence[Row]) -> list[Row]:
    """Add p values adjusted over the strategies, and order by area."""
    compared = [row for row in rows if row["p_value"] is not None]
    found = holm([row["p_value"] for row in compared])
    adjusted = {row["strategy"]: value for row, value in zip(compared, found, strict=True)}
    full = [{**row, "adjusted_p": adjusted.get(row["strategy"])} for row in rows]
    return sorted(full, key=lambda row: -row["area"])
