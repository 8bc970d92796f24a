"""Fill the tables of README.md from the kept accuracies: `make readme` and `make turned`."""

from __future__ import annotations

import textwrap
from pathlib import Path

from filling import fill_page, table

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import with_interval
from visuohaptic.report.turned import TurnedRow, read_turned, turned_rows
from visuohaptic.report.wording import classifier_name, percent, points

PAGE = Path(__file__).parent / "README.md"
HEADS = ["objects", "pipeline", "pose", "draws", "fixation", "random, in reach", "lead of fixation"]


def blocks() -> dict[str, str]:
    """Return the table of the page, by the name of its block."""
    kept = read_turned()
    rows = [
        _cells(row)
        for name in sorted(kept, key="paper".__ne__)
        for row in turned_rows(kept[name], IntervalParameters())
    ]
    sources = ", ".join(
        f"{name}: commit {one.commit[:12]}, {one.date}" for name, one in kept.items()
    )
    source = textwrap.fill(f"Measured once and kept; {sources}.", 100, break_on_hyphens=False)
    return {"turned": f"{table(HEADS, rows)}\n\n{source}"}


def _cells(row: TurnedRow) -> list[object]:
    found = [
        row.objects,
        f"{row.pipeline}, {classifier_name(row.classifier)}",
        row.pose,
        row.draws,
        with_interval(row.fixation, percent),
        with_interval(row.random, percent),
        with_interval(row.lead, points),
    ]
    return [str(one).replace("\N{NO-BREAK SPACE}", " ") for one in found]


if __name__ == "__main__":
    fill_page(PAGE, blocks())
