"""Fill README.md and draw the picture from the kept variants: `make readme`."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import compress
from pathlib import Path

from filling import fill_page, lead_with_p, points, resized, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from variants.choices import BEST_OF_PAPER, BY_NAME, OPPONENTS
from variants.design import is_default, is_literal
from variants.kept import OUTSIDE, PAPER_SET, kept_variants
from variants.leads import (
    MAIN_OPPONENT,
    after_holm,
    count_after_holm,
    strongest_pair,
    sum_up,
)
from variants.verdicts import lead_evidence, of_papers_question, verdict
from variants.weighing import summarise_variants
from visuohaptic.evaluation.intervals import holm
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.report.drawing import COLOURS, look, new_chart, style
from visuohaptic.report.figures import as_points, label_axes, whole_percent
from visuohaptic.studies.figures import Row

PAGE = Path(__file__).parent / "README.md"
PICTURE = PAGE.with_name("variants.png")
OPPONENT_WORDS = {
    "reachable": "in reach",
    "anywhere": "anywhere",
    "visible": "in sight",
    "walk": "a walk",
}


def spread_table(tables: Mapping[str, list[Row]]) -> str:
    """Write the table of the leads of all variants with the SVM: one row per set and kind of random touches."""
    lines = []
    written = _main_leads(tables)
    for option in OPPONENTS:
        word = verdict(lead_evidence(tables, BEST_OF_PAPER, option))
        for name, rows in tables.items():
            run = of_papers_question(rows, BEST_OF_PAPER, option)
            if not run:
                continue
            lead = sum_up(run)
            lines.append(
                [
                    max(row["objects"] for row in run),
                    OPPONENT_WORDS[option],
                    written.get((option, name, "default"), ""),
                    written.get((option, name, "literal"), ""),
                    f"{lead.ahead_singly}, {lead.behind_singly} of {len(run)}",
                    "{}, {}".format(*count_after_holm(run)),
                    word,
                ]
            )
    heads = ["objects", "random", "default", "most literal", "ahead, behind", "after Holm"]
    return table([*heads, "verdict"], lines)


def pair_sentence(tables: Mapping[str, list[Row]]) -> str:
    """Write how much of the variance of the leads the two choices explain on which they depend most."""
    said, choices = [], set()
    for name, rows in tables.items():
        pair = strongest_pair(rows)
        if pair is not None:
            choices.add(pair.choices)
            middles = [lead.middle for lead in pair.leads.values()]
            said.append(
                f"{share(pair.share, 0)} of the variance of the leads of set {name}, with median leads of their options from "
                f"{points(min(middles))} to {points(max(middles))} points"
            )
    (labels,) = [[BY_NAME[choice].label.lower() for choice in pair] for pair in choices]
    return (
        f"Over places in reach and the five classifiers two choices, *{'* and *'.join(labels)}*, explain "
        f"{', and '.join(said)}."
    )


def reached_sentence(tables: Mapping[str, list[Row]]) -> str:
    """Write which accuracies the variants reach by fixation with the SVM, and how many reach the published accuracy."""
    said, reaching = [], 0
    for name, rows in tables.items():
        found = summarise_variants(rows)["classifiers"][BEST_OF_PAPER]
        reaching += found["variants_reaching"]
        lowest, middle, highest = (share(found[key]) for key in ("lowest", "median", "highest"))
        said.append(
            f"{lowest} to {highest}, median {middle}, over {found['variants']} variants of set {name}"
        )
    published = share(TABLE_1[BEST_OF_PAPER]["fixation"], 2)
    return f"By fixation the SVM has {', and '.join(said)}; {reaching} reach the published {published}."


def draw(tables: Mapping[str, list[Row]]) -> Figure:
    """Draw the leads of all variants over random places in reach with the SVM, smallest first, one line per set.

    Dots are leads with p below 0.05 after Holm's correction for all leads of the set.
    """
    with style():
        chart, axes = new_chart(250)
        for place, rows in enumerate(tables.values()):
            run = sorted(
                of_papers_question(rows, BEST_OF_PAPER, MAIN_OPPONENT), key=lambda row: row["ahead"]
            )
            share_below = [(index + 0.5) / len(run) for index in range(len(run))]
            colour, mark = look(place)
            leads = [row["ahead"] for row in run]
            label = f"{max(row['objects'] for row in run)} objects, {len(run)} variants"
            axes.plot(share_below, leads, color=colour, linewidth=1)
            stands = after_holm(run)
            label += f"; {sum(stands)} stand after Holm (dots)"
            dots = [[*compress(values, stands)] for values in (share_below, leads)]
            axes.plot(
                *dots, "o", color=colour, markersize=5, markeredgecolor="white", markeredgewidth=0.4
            )
            axes.plot([], [], "o-", color=colour, label=label)
            for index, row in enumerate(run):
                is_shown = is_default(row), is_literal({**row, "random_probing": "walk"})
                if any(is_shown):
                    ground = colour if is_shown[0] else "white"
                    place_of = share_below[index], row["ahead"]
                    axes.plot(*place_of, mark, color=colour, mfc=ground, markersize=8)
        axes.axhline(0, color=COLOURS["ink"], linewidth=1)
        named = label_axes(
            chart,
            "share of the variants with a smaller lead",
            "lead, percentage points",
            xformat=whole_percent,
            yformat=as_points,
            columns=1,
        )
    return resized(named, 320)


def _main_leads(tables: Mapping[str, list[Row]]) -> dict[tuple[str, str, str], str]:
    """Write the leads of both variants by random touches, set and variant; bold have p < 0.05 after Holm's correction."""
    found = [
        (option, one)
        for option in OPPONENTS
        for one in lead_evidence(tables, BEST_OF_PAPER, option)
        if one.variant != "other"
    ]
    adjusted = holm([one.p_value for _, one in found])
    return {
        (option, one.objects, one.variant): lead_with_p(one.difference, one.p_value, p)
        for (option, one), p in zip(found, adjusted, strict=True)
    }


def tables_of_sets() -> dict[str, list[Row]]:
    """Return the kept variants by set of objects."""
    return {"paper": kept_variants(PAPER_SET).rows, "outside": kept_variants(OUTSIDE).rows}


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    tables = tables_of_sets()
    return {
        "spread": spread_table(tables),
        "reached": wrapped(reached_sentence(tables)),
        "pair": wrapped(pair_sentence(tables)),
    }


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(tables_of_sets()), PICTURE)
