"""Fill the table of README.md from the kept draws: `make readme` and `make draws`."""

from __future__ import annotations

from pathlib import Path

from filling import fill_page, points, share, table

from visuohaptic.report.draws import KeptDraws, read_draws, read_kept
from visuohaptic.report.wording import classifier_name, percent_points

PAGE = Path(__file__).parent / "README.md"


def blocks() -> dict[str, str]:
    """Return the table of the page, by the name of its block."""
    kept = read_kept()
    found = [
        read_draws(name, pipeline)
        for name in sorted(kept)
        for pipeline in sorted(kept[name].pipelines, key="paper".__ne__)
    ]
    heads = ["set", "objects", "pipeline", "draws", "fixation", "random: mean", "lead: lowest"]
    heads += ["mean", "highest", "standard deviation", "commit", "day"]
    return {"draws": table(heads, [_row(one) for one in found if one is not None])}


def _row(one: KeptDraws) -> list[object]:
    leads = one.lead.leads
    return [
        one.set,
        one.objects,
        f"{one.pipeline}, {classifier_name(one.classifier)}",
        one.lead.count,
        share(one.fixation),
        share(sum(one.random) / len(one.random)),
        points(min(leads)),
        points(one.lead.mean),
        points(max(leads)),
        percent_points(one.lead.standard_deviation),
        one.commit[:12],
        one.date,
    ]


if __name__ == "__main__":
    fill_page(PAGE, blocks())
