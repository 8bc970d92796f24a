"""Fill the table of README.md from the kept draws: `make readme` and `make draws`."""

from __future__ import annotations

from pathlib import Path

from filling import fill_page, points, share, table

from draws.kept import KeptDraws, read_draws, read_kept
from draws.study import RANDOM
from visuohaptic.report.leads import PLACES
from visuohaptic.report.wording import classifier_name, percent_points

_ORDER = ("paper", "literal", "order_free")
PAGE = Path(__file__).parent / "README.md"


def blocks() -> dict[str, str]:
    """Return the table of the page by name of the block."""
    kept = read_kept()
    draws = [
        read_draws(name, pipeline, opponent=opponent)
        for name in sorted(kept)
        for pipeline in sorted(kept[name].pipelines, key=_ORDER.index)
        for opponent in RANDOM
    ]
    heads = ["set", "objects", "pipeline", "random places", "draws", "fixation", "random: mean"]
    heads += ["lead: lowest"]
    heads += ["mean", "highest", "standard deviation", "commit", "day"]
    return {"draws": table(heads, [_row(kept) for kept in draws if kept is not None])}


def _row(kept: KeptDraws) -> list[object]:
    leads = kept.lead.leads
    return [
        kept.source.set,
        kept.objects,
        f"{kept.pipeline}, {classifier_name(kept.classifier)}",
        PLACES[kept.opponent].removeprefix("random places "),
        kept.lead.count,
        share(kept.fixation),
        share(sum(kept.random) / len(kept.random)),
        points(min(leads)),
        points(kept.lead.mean),
        points(max(leads)),
        percent_points(kept.lead.standard_deviation),
        kept.source.commit[:12],
        kept.source.date,
    ]


if __name__ == "__main__":
    fill_page(PAGE, blocks())
