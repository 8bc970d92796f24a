"""Fill README.md and draw its picture from the kept figures of this study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from filling import (
    Figures,
    difference,
    estimated,
    figures_of_study,
    fill_page,
    measured,
    save_picture,
    share,
    table,
    wrapped,
)
from matplotlib.figure import Figure

from visuohaptic.report.estimates import figure_of
from visuohaptic.report.figures import Series, draw_by_touches

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
PICTURE = HERE / "known_objects.png"
SETS = {"ycb": "YCB", "paper": "the paper set's"}
SHOWN = (1, 2, 5, 10, 20)
"""Numbers of touches of the picture."""
IN_TABLE = (1, 10, 20)
LEADS_AT = (2, 20)

NAMES = {"fixation": "eye fixations", "random": "random places, in reach"}

Sets = Mapping[str, list[Figures]]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    sets: Sets = figures_of_study(HERE, SETS)
    heads = ["objects", "touches by", *(_counted(number) for number in IN_TABLE)]
    heads += ["half of the views certain by", "ever certain", "certain answers that are right"]
    return {
        "accuracy": table(heads, _rows(sets)),
        "leads": wrapped(lead_sentence(sets)),
        "worst": wrapped(worst_sentence(sets["ycb"])),
        "measured": measured(HERE, {name: f"{words} objects" for name, words in SETS.items()}),
    }


def lead_sentence(sets: Sets) -> str:
    """Return the lead of fixation over random places, and how many intervals exclude 0."""
    said = []
    for name, words in SETS.items():
        (rows,) = (one["by_touches"] for one in sets[name] if one["strategy"] != "fixation")
        leads = {number: rows[number - 1] for number in SHOWN}
        shown = sum(row["lead_low"] > 0 or row["lead_high"] < 0 for row in leads.values())
        written = " and ".join(
            f"{difference(leads[number], 'lead', 'lead_low', 'lead_high', 'p_value')} at {_counted(number)}"
            for number in LEADS_AT
        )
        said.append(
            f"on {words} objects {written}; {shown} of the {len(leads)} intervals of the picture exclude 0"
        )
    return (
        f"Fixation minus random places, in points: {'; '.join(said)}. P values are not corrected."
    )


def worst_sentence(strategies: list[Figures]) -> str:
    """Return the objects with the lowest accuracies by fixation."""
    (one,) = (one for one in strategies if one["strategy"] == "fixation")
    lowest = sorted(zip(one["accuracy"], one["objects"], strict=True))[:4]
    listed = ", ".join(f"{key.split('/')[1]} {share(value)}" for value, key in lowest)
    return f"After {len(one['by_touches'])} fixations the lowest accuracies are {listed}."


def draw(sets: Sets) -> Figure:
    """Draw accuracy against touches, by set of objects and strategy."""
    series = [
        Series(
            f"{name} {len(one['objects'])}, {NAMES[one['strategy']]}",
            place,
            [figure_of(one["by_touches"][number - 1], "accuracy") for number in SHOWN],
        )
        for place, (name, one) in enumerate(
            (SETS[name], one) for name, strategies in sets.items() for one in strategies
        )
    ]
    return draw_by_touches(SHOWN, series)


def _rows(sets: Sets) -> Iterator[list[object]]:
    for name, strategies in sets.items():
        for one in strategies:
            stopping = one["stopping"]
            yield [
                f"{SETS[name]} {len(one['objects'])}",
                NAMES[one["strategy"]],
                *(_share(one["by_touches"][number - 1], "accuracy") for number in IN_TABLE),
                "never" if stopping["median"] is None else _counted(stopping["median"]),
                _share(stopping, "certain"),
                _share(stopping, "right"),
            ]


def _share(row: Figures, name: str) -> str:
    found = figure_of(row, name)
    return "none" if found is None else estimated(found)


def _counted(touches: int) -> str:
    return f"{touches} touch{'' if touches == 1 else 'es'}"


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(figures_of_study(HERE, SETS)), PICTURE)
