"""Fill the tables of README.md from the kept figures of this study."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from filling import Figures, difference, figures_of_study, fill_page, measured, share, table

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
SETS = {"ycb": "YCB", "paper": "the paper set's"}
SHOWN = (1, 2, 5, 10, 20)
"""Numbers of touches of the table."""

NAMES = {"fixation": "eye fixations", "random": "random places, in reach"}


def blocks() -> dict[str, str]:
    """Return the tables of the page, by the names of their blocks."""
    sets = figures_of_study(HERE, SETS)
    strategies = [(SETS[name], one) for name, figures in sets.items() for one in figures]
    heads = ["objects", "touches by", *(f"{one} touch{'' if one == 1 else 'es'}" for one in SHOWN)]
    return {
        "accuracy": table(heads, [_accuracies(*one) for one in strategies]),
        "leads": table(heads, [_leads(*one) for one in strategies if one[1]["strategy"] != "fixation"]),
        "certain": table(
            [
                "objects", "touches by", "views that become certain", "certain answers that are right",
                "half of the views by touch", "mean touches", "right when it stops",
            ],
            [_certain(*one) for one in strategies],
        ),
        "objects": table(
            ["object", *(NAMES[one["strategy"]] for one in sets["ycb"])],
            _objects(sets["ycb"]),
        ),
        "measured": measured(HERE, {name: f"{words} objects" for name, words in SETS.items()}),
    }  # fmt: skip


def _accuracies(name: str, one: Figures) -> list[object]:
    rows = (one["by_touches"][touches - 1] for touches in SHOWN)
    return [*_named(name, one), *(_interval(row, "accuracy", "") for row in rows)]


def _leads(name: str, one: Figures) -> list[object]:
    rows = (one["by_touches"][touches - 1] for touches in SHOWN)
    names = ("lead", "lead_low", "lead_high", "p_value")
    return [*_named(name, one), *(difference(row, *names) for row in rows)]


def _certain(name: str, one: Figures) -> list[object]:
    stopping = one["stopping"]
    made = (stopping[key] for key in ("made", "made_low", "made_high"))
    mean, low, high = (f"{value:.1f}" for value in made)
    return [
        *_named(name, one),
        _interval(stopping, "certain"),
        _interval(stopping, "right"),
        "never" if stopping["median"] is None else stopping["median"],
        f"{mean} ({low}–{high})",
        _interval(stopping, "stopped"),
    ]


def _objects(strategies: list[Figures]) -> Iterator[list[object]]:
    for index, key in enumerate(strategies[0]["objects"]):
        yield [key.split("/")[1], *(share(one["accuracy"][index]) for one in strategies)]


def _named(name: str, one: Figures) -> list[object]:
    return [f"{name} {len(one['objects'])}", NAMES[one["strategy"]]]


def _interval(row: Figures, name: str, prefix: str | None = None) -> str:
    """Return a share in per cent with the ends of its interval."""
    if row[name] is None:
        return "none"
    prefix = f"{name}_" if prefix is None else prefix
    low, high = (row[f"{prefix}{end}"] for end in ("low", "high"))
    return f"{share(row[name])} ({100 * low:.1f}–{100 * high:.1f})"


if __name__ == "__main__":
    fill_page(PAGE, blocks())
