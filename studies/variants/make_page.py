"""Fill the tables of README.md and of the study's notebook from the kept variants: `make readme`."""

from __future__ import annotations

import statistics
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path

from filling import DOCS, fill_page, points, share, table

from draws.kept import read_draws
from variants.choices import BEST_OF_PAPER, BY_NAME, OPPONENTS
from variants.design import is_default, is_literal
from variants.kept import OUTSIDE, PAPER_SET, kept_variants
from variants.leads import count_after_holm, leads_by_option, strongest_pair, sum_up
from variants.verdicts import lead_evidence, of_papers_question, verdict
from visuohaptic.report.wording import percent_points
from visuohaptic.studies.figures import Row

PAGE = Path(__file__).parent / "README.md"
NOTEBOOK = DOCS / "notebook" / "2026-11-variants.md"
OPPONENT_WORDS = {
    "reachable": "in reach, `random`",
    "anywhere": "anywhere, `random_anywhere`",
    "visible": "among what the eye sees, `random_visible`",
    "walk": "a walk, `random_walk`",
}


def spread_table(tables: dict[str, list[Row]]) -> str:
    """Write the table of the spread of all variants with the SVM: one row per set and kind of random touches."""
    lines = []
    for option in OPPONENTS:
        word = verdict(lead_evidence(tables, BEST_OF_PAPER, option))
        for name, rows in tables.items():
            run = of_papers_question(rows, BEST_OF_PAPER, option)
            if not run:
                continue
            reached = sorted(row["fixation"] for row in run)
            spread = (reached[0], statistics.median(reached), reached[-1])
            lead = sum_up(run)
            lines.append(
                [
                    f"{max(row['objects'] for row in run)} ({name})",
                    OPPONENT_WORDS[option],
                    len(run),
                    ", ".join(map(share, spread)),
                    _lead(run, is_default),
                    _lead(run, is_literal),
                    *(lead.ahead, lead.ahead_singly, lead.behind_singly),
                    "{}, {}".format(*count_after_holm(run)),
                    points(lead.middle),
                    word,
                ]
            )
    heads = [
        "objects",
        "random touches",
        "variants",
        "fixation: lowest, median, highest",
        "default",
    ]
    heads += [
        "most literal",
        "fixation ahead",
        "p < 0.05 singly",
        "behind, p < 0.05 singly",
        "after Holm: ahead, behind",
        "median lead",
    ]
    return table([*heads, "verdict"], lines)


def options_table(tables: dict[str, list[Row]]) -> str:
    """Write the table of the median lead of fixation under each option, over all five classifiers."""
    leads = {name: leads_by_option(rows) for name, rows in tables.items()}
    rows = []
    for choice, option in dict.fromkeys(key for by_option in leads.values() for key in by_option):
        label = BY_NAME[choice].label[0].lower() + BY_NAME[choice].label[1:]
        cells = [by_option.get((choice, option)) for by_option in leads.values()]
        texts = (
            f"{points(lead.middle)} ({share(lead.ahead / lead.cases, 0)} of {lead.cases})"
            if lead
            else ""
            for lead in cells
        )
        rows.append([label, option.replace("_", " "), *texts])
    return table(["choice", "option", *(f"median lead, {name}" for name in leads)], rows)


def pair_table(tables: dict[str, list[Row]]) -> str:
    """Write one table per set of the leads by the two choices on which they depend most."""
    paragraphs = []
    for name, rows in tables.items():
        pair = strongest_pair(rows)
        if pair is None:
            continue
        labels = [BY_NAME[choice].label.lower() for choice in pair.choices]
        lines = []
        for options, lead in pair.leads.items():
            words = (option.replace("_", " ") for option in options)
            lines.append([*words, points(lead.middle), f"{lead.ahead} of {lead.cases}"])
        paragraphs += [
            f"Set {name}: the two choices explain {share(pair.share, 0)} of the variance of the leads.",
            table([*labels, "median lead", "fixation ahead"], lines),
        ]
    return "\n\n".join(paragraphs)


def _lead(rows: Sequence[Row], is_wanted: Callable[[Row], bool]) -> str:
    opponent = "walk" if is_wanted is is_literal else "reachable"
    wanted = [row for row in rows if is_wanted(dict(row) | {"random_probing": opponent})]
    if len(wanted) != 1:
        return ""
    (row,) = wanted
    return f"{points(row['ahead'])} ({points(row['ahead_low'])} to {points(row['ahead_high'])})"


def draws_sentence() -> str:
    """Write how far one draw of random locations moves the lead of a variant, from the kept draws of the default."""
    kept = read_draws("paper", "paper")
    if kept is None:
        return ""
    spread = percent_points(kept.lead.standard_deviation)
    text = (
        f"Each variant has one draw of its random places. In {kept.lead.count} draws of the default on the paper's "
        f"set (commit {kept.source.commit[:12]}) the lead lies between {points(min(kept.lead.leads))} and "
        f"{points(max(kept.lead.leads))} points, standard deviation {spread}: the typical change of a lead from one "
        "draw to another."
    )
    return textwrap.fill(text, 100, break_on_hyphens=False)


def blocks() -> dict[Path, dict[str, str]]:
    """Return the tables of each page by name of the block."""
    tables = {"paper": kept_variants(PAPER_SET).rows, "outside": kept_variants(OUTSIDE).rows}
    return {
        PAGE: {
            "spread": spread_table(tables),
            "draws": draws_sentence(),
            "pair": pair_table(tables),
        },
        NOTEBOOK: {"options": options_table(tables)},
    }


if __name__ == "__main__":
    for page, tables in blocks().items():
        fill_page(page, tables)
