"""Fill the tables of README.md and of the study's notebook from the kept variants: `make readme`."""

from __future__ import annotations

import statistics
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path

from filling import DOCS, fill_page, points, share, table

from variants.choices import BEST_OF_PAPER, BY_NAME, OPPONENTS
from variants.design import is_default, is_literal
from variants.kept import OUTSIDE, PAPER_SET, kept_variants
from variants.leads import leads_by_option, strongest_pair, sum_up
from variants.verdicts import lead_evidence, of_papers_question, verdict
from visuohaptic.report.draws import read_draws
from visuohaptic.report.wording import percent_points
from visuohaptic.studies.figures import Row

PAGE = Path(__file__).parent / "README.md"
NOTEBOOK = DOCS / "notebook" / "2026-11-variants.md"
OPPONENT_WORDS = {
    "reachable": "in reach",
    "anywhere": "anywhere",
    "visible": "among what the eye sees",
    "walk": "a walk",
}


def spread_table(tables: dict[str, list[Row]]) -> str:
    """Set the spread of all variants, with the SVM, in a row a set and kind of random touches."""
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
                    *(lead.ahead, lead.ahead_significantly, lead.behind_significantly),
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
        "significantly",
        "significantly behind",
        "median lead",
    ]
    return table([*heads, "verdict"], lines)


def options_table(tables: dict[str, list[Row]]) -> str:
    """Set the median lead of fixation under each option, over all five classifiers, in a table."""
    leads = {name: leads_by_option(rows) for name, rows in tables.items()}
    rows = []
    for choice, option in dict.fromkeys(key for found in leads.values() for key in found):
        label = BY_NAME[choice].label[0].lower() + BY_NAME[choice].label[1:]
        cells = [found.get((choice, option)) for found in leads.values()]
        texts = (
            f"{points(one.middle)} ({share(one.ahead / one.cases, 0)} of {one.cases})"
            if one
            else ""
            for one in cells
        )
        rows.append([label, option.replace("_", " "), *texts])
    return table(["choice", "option", *(f"median lead, {name}" for name in leads)], rows)


def pair_table(tables: dict[str, list[Row]]) -> str:
    """Set the leads by the two choices on which they depend most in a table, set by set."""
    found = []
    for name, rows in tables.items():
        pair = strongest_pair(rows)
        if pair is None:
            continue
        labels = [BY_NAME[choice].label.lower() for choice in pair.choices]
        lines = []
        for options, lead in pair.leads.items():
            words = (option.replace("_", " ") for option in options)
            lines.append([*words, points(lead.middle), f"{lead.ahead} of {lead.cases}"])
        found += [
            f"Set {name}: the two choices explain {share(pair.share, 0)} of how leads differ.",
            table([*labels, "median lead", "fixation ahead"], lines),
        ]
    return "\n\n".join(found)


def _lead(rows: Sequence[Row], is_one: Callable[[Row], bool]) -> str:
    own = "walk" if is_one is is_literal else "reachable"
    found = [row for row in rows if is_one(dict(row) | {"random_probing": own})]
    if len(found) != 1:
        return ""
    (row,) = found
    return f"{points(row['ahead'])} ({points(row['ahead_low'])} to {points(row['ahead_high'])})"


def draws_sentence() -> str:
    """Say how far one draw of random places moves the lead of a variant, from the kept draws of the default."""
    kept = read_draws("paper", "paper")
    if kept is None:
        return ""
    spread = percent_points(kept.lead.standard_deviation)
    text = (
        f"Each variant has one draw of its random places. In {kept.lead.count} draws of the default on the paper's "
        f"set (commit {kept.commit[:12]}) the lead lies between {points(min(kept.lead.leads))} and "
        f"{points(max(kept.lead.leads))} points, standard deviation {spread}: about so far another draw moves the "
        "lead of one variant."
    )
    return textwrap.fill(text, 100, break_on_hyphens=False)


def blocks() -> dict[Path, dict[str, str]]:
    """Give the tables of each page, by the names of their blocks."""
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
