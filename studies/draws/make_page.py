"""Fill README.md and draw its picture from the kept draws: `make readme` and `make draws`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from filling import fill_page, points, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from draws.kept import KeptDraws, read_draws, read_kept
from draws.study import RANDOM
from visuohaptic.report.estimates import Figure as Estimate
from visuohaptic.report.figures import Series, draw_leads
from visuohaptic.report.leads import PLACES
from visuohaptic.report.wording import percent_points, pipeline_name

_ORDER = ("paper", "literal", "order_free")
PAGE = Path(__file__).parent / "README.md"
PICTURE = PAGE.with_name("draws.png")


def kept_draws() -> list[KeptDraws]:
    """Return the kept draws of each set, pipeline and kind of random places, the largest set first."""
    kept = read_kept()
    found = [
        read_draws(name, pipeline, opponent=opponent)
        for name in kept
        for pipeline in sorted(kept[name].pipelines, key=_ORDER.index)
        for opponent in RANDOM
    ]
    return sorted((one for one in found if one is not None), key=lambda one: -one.objects)


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    draws = kept_draws()
    heads = ["objects", "pipeline", "random places", "draws", "fixation", "random: mean"]
    heads += ["lead: mean (lowest to highest)", "standard deviation"]
    sources = dict.fromkeys(
        f"{one.objects} objects: {one.source.commit[:12]}, {one.source.date}" for one in draws
    )
    return {
        "draws": table(heads, map(_row, draws)),
        "sources": wrapped(f"Measured once and kept; {'; '.join(sources)}."),
    }


def draw(draws: Sequence[KeptDraws]) -> Figure:
    """Draw the mean lead with its range over draws, one row per pipeline and kind of places, one mark per set."""
    places = dict.fromkeys((one.pipeline, one.opponent) for one in draws)
    series = []
    for index, count in enumerate(dict.fromkeys(one.objects for one in draws)):
        of_set = {(one.pipeline, one.opponent): one.lead for one in draws if one.objects == count}
        ranges = [
            Estimate(of_set[key].mean, min(of_set[key].leads), max(of_set[key].leads))
            for key in places
        ]
        series.append(Series(f"{count} objects", index, ranges))
    rows = [f"{_named(pipeline)}, {_places(opponent)}" for pipeline, opponent in places]
    return draw_leads(rows, "pipeline and random places", series)


def _named(pipeline: str) -> str:
    return "the most literal variant" if pipeline == "literal" else pipeline_name(pipeline)


def _places(opponent: str) -> str:
    return PLACES[opponent].removeprefix("random places ")


def _row(kept: KeptDraws) -> list[object]:
    leads = kept.lead.leads
    return [
        kept.objects,
        _named(kept.pipeline),
        _places(kept.opponent),
        kept.lead.count,
        share(kept.fixation),
        share(sum(kept.random) / len(kept.random)),
        f"{points(kept.lead.mean)} ({points(min(leads))} to {points(max(leads))})",
        percent_points(kept.lead.standard_deviation),
    ]


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(kept_draws()), PICTURE)
