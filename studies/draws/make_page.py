"""Fill README.md and draw its picture from the kept draws: `make readme` and `make draws`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from filling import fill_page, measured, points, resized, save_picture, table
from matplotlib.figure import Figure

from draws.kept import KeptDraws, read_draws, read_kept
from draws.study import RANDOM
from visuohaptic.evaluation.means_over_draws import LeadOverDraws
from visuohaptic.report.estimates import Estimate
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
    return {
        "draws": draws_table(draws),
        "sources": measured(PAGE.parent),
    }


def draws_table(draws: Sequence[KeptDraws]) -> str:
    """Return the lead and its standard deviation over draws, one row per pipeline and kind of places."""
    counts = list(dict.fromkeys(one.objects for one in draws))
    found = {(one.pipeline, one.opponent, one.objects): one.lead for one in draws}
    heads = ["pipeline", "random places", "draws"]
    for count in counts:
        heads += [f"{count} objects: mean (lowest to highest)", "standard deviation"]
    rows = []
    for pipeline, opponent in dict.fromkeys((one.pipeline, one.opponent) for one in draws):
        leads = [found[pipeline, opponent, count] for count in counts]
        (number,) = {lead.count for lead in leads}
        cells = [cell for lead in leads for cell in _cells(lead)]
        rows.append([_named(pipeline), _places(opponent), number, *cells])
    return table(heads, rows)


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
    return resized(draw_leads(rows, "pipeline and random places", series), 340)


def _named(pipeline: str) -> str:
    return "the most literal variant" if pipeline == "literal" else pipeline_name(pipeline)


def _places(opponent: str) -> str:
    return PLACES[opponent].removeprefix("random places ")


def _cells(lead: LeadOverDraws) -> list[str]:
    lowest, highest = points(min(lead.leads)), points(max(lead.leads))
    return [
        f"{points(lead.mean)} ({lowest} to {highest})",
        percent_points(lead.standard_deviation),
    ]


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(kept_draws()), PICTURE)
