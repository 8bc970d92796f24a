"""Fill README.md and draw its picture from the kept figures of this study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from filling import (
    Figures,
    difference,
    estimated,
    figures_of_study,
    fill_page,
    legend_beside,
    measured,
    read_json,
    resized,
    save_picture,
    share,
    table,
    wrapped,
)
from matplotlib.figure import Figure

from known_objects.network import MEASURED, TOUCHES, count_shown
from visuohaptic.report.estimates import Estimate, estimate_of, with_interval
from visuohaptic.report.figures import Series, draw_by_touches
from visuohaptic.report.wording import points

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
PICTURE = HERE / "known_objects.png"
SETS = {"ycb": "YCB", "paper": "the paper set's"}
SHOWN = (1, 2, 5, 10, 20)
"""Numbers of touches of the picture."""
IN_TABLE = (20,)
LEADS_AT = (2, 20)

NAMES = {"fixation": "eye fixations", "random": "random places, in reach"}

Sets = Mapping[str, list[Figures]]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    sets: Sets = figures_of_study(HERE, SETS)
    heads = ["objects", "touches by", *(_counted(number) for number in IN_TABLE)]
    heads += ["half", "ever certain", "right"]
    return {
        "answer": wrapped(answer_sentence(sets)),
        "accuracy": table(heads, _rows(sets)),
        "leads": wrapped(lead_sentence(sets)),
        "network": wrapped(network_sentence(read_json(MEASURED))),
        "measured": measured(HERE, {name: f"{words} objects" for name, words in SETS.items()}),
    }


def answer_sentence(sets: Sets) -> str:
    """Return the range of the accuracies after all touches, and of the touches by which half of the views are certain."""
    every = [one for strategies in sets.values() for one in strategies]
    last = sorted(one["by_touches"][-1]["accuracy"] for one in every)
    half = sorted(one["stopping"]["median"] for one in every)
    return (
        f"**After {len(every[0]['by_touches'])} touches {share(last[0], 0)} to {share(last[-1], 0)} of the objects are named "
        f"right, and half of the views are certain after {half[0]} to {half[-1]} touches.** Certain is a probability of at "
        f"least 95 %, calibrated on training poses that were held out."
    )


def lead_sentence(sets: Sets) -> str:
    """Return the lead of fixation over random places, and how many intervals of the picture exclude 0."""
    said, shown = [], []
    for name, words in SETS.items():
        (rows,) = (one["by_touches"] for one in sets[name] if one["strategy"] != "fixation")
        shown += [row["lead_low"] > 0 or row["lead_high"] < 0 for row in _at(rows, SHOWN)]
        written = " and ".join(
            f"{difference(row, 'lead', 'lead_low', 'lead_high', 'p_value')} at {number}"
            for number, row in zip(LEADS_AT, _at(rows, LEADS_AT), strict=True)
        )
        said.append(f"{written} on {words} objects")
    verdict = "" if any(shown) else "**Fixation is not shown to be ahead.** "
    return (
        f"{verdict}Of {len(shown)} intervals of its lead over random places {sum(shown)} exclude 0; in points by touches, p not "
        f"corrected: {'; '.join(said)}."
    )


def network_sentence(found: Mapping[str, list[Figures]]) -> str:
    """Return the accuracies by fixation of both pipelines, and how many gains stand after Holm's correction."""
    said = []
    for name, words in SETS.items():
        by_touches = " and ".join(
            f"{share(row['order_free'])} → {share(row['learned'])}, {with_interval(Estimate(**row['difference']), points)}, with "
            f"{row['touches']} touches"
            for row in found[name]
            if row["strategy"] == "fixation"
        )
        said.append(f"On {words} objects: {by_touches}.")
    shown, total = count_shown(found)
    return (
        f"**By pipeline `learned` in place of `order_free` {shown} of {total} gains are shown** (both ways of touching, "
        f"{' and '.join(map(str, TOUCHES))} touches, Holm's correction for all; no question was written before). By fixation: "
        f"{' '.join(said)}"
    )


def _at(rows: list[Figures], numbers: Sequence[int]) -> list[Figures]:
    return [rows[number - 1] for number in numbers]


def draw(sets: Sets) -> Figure:
    """Draw accuracy against touches, by set of objects and strategy."""
    series = [
        Series(
            f"{name} {len(one['objects'])}, {NAMES[one['strategy']]}",
            place,
            [estimate_of(one["by_touches"][number - 1], "accuracy") for number in SHOWN],
        )
        for place, (name, one) in enumerate(
            (SETS[name], one) for name, strategies in sets.items() for one in strategies
        )
    ]
    return resized(legend_beside(draw_by_touches(SHOWN, series)), 320)


def _rows(sets: Sets) -> Iterator[list[object]]:
    for name, strategies in sets.items():
        for one in strategies:
            stopping = one["stopping"]
            yield [
                f"{SETS[name]} {len(one['objects'])}",
                one["strategy"],
                *(_share(one["by_touches"][number - 1], "accuracy") for number in IN_TABLE),
                "never" if stopping["median"] is None else _counted(stopping["median"]),
                _share(stopping, "certain"),
                _share(stopping, "right"),
            ]


def _share(row: Figures, name: str) -> str:
    found = estimate_of(row, name)
    return "none" if found is None else estimated(found)


def _counted(touches: int) -> str:
    return f"{touches} touch{'' if touches == 1 else 'es'}"


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(figures_of_study(HERE, SETS)), PICTURE)
