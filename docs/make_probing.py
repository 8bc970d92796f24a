"""Fill the tables of places out of reach from kept figures: `make readme`.

docs/figures/out_of_reach_paper.json and out_of_reach_benchmark.json have, by set, the command, commit and day of study
`out_of_reach`, its figures (``reports/studies/out_of_reach.json``), and the views of each condition and strategy.
docs/figures/ranks.parquet has the columns ``touch`` and ``rank`` of all touches by fixation in the same runs.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping

import pyarrow as pa
import pyarrow.compute as pc
from filling import (
    DOCS,
    SETS,
    Figures,
    fill_page,
    kept_figures,
    lead_in_both,
    points,
    share,
    table,
)

from visuohaptic.evaluation.intervals import SIGNIFICANCE, holm
from visuohaptic.evaluation.own_fixations import count_own_fixations
from visuohaptic.tables.schema import open_parquet

PAGE = DOCS / "probing.md"
KEPT = DOCS / "figures" / "out_of_reach"
RANKS = DOCS / "figures" / "ranks.parquet"
CONDITIONS = {"replace": "as run", "skip": "skip", "keep": "keep"}
STRATEGIES = ("fixation", "random_visible")
PIPELINES = ("paper", "order_free")
FIXATIONS = 5


def shares_table(ranks: pa.Table) -> str:
    """Set the shares of views and touches that are not at the eye's first five fixations, by set."""
    found = []
    for name in SETS:
        of_set = ranks.filter(pc.equal(ranks.column("set"), name))
        found.append(count_own_fixations(of_set, of_set, FIXATIONS))
    counted = {
        "views touched at exactly their first five fixations, in order": "views_as_fixated",
        "touches that are not at the fixation of the same number": "touches_out_of_turn",
        "touches at none of the view's first five fixations": "touches_elsewhere",
    }
    rows = [
        [words, *(share(getattr(one, name)) for one in found)] for words, name in counted.items()
    ]
    return table(["with `replace`", *SETS.values()], rows)


def accuracies_table(kept: Figures) -> str:
    """Set the accuracy by fixation and its lead over random places in sight, by treatment."""
    cells = {
        (condition, pipeline): [
            _cell(kept, pipeline, strategy, condition) for strategy in STRATEGIES
        ]
        for condition in CONDITIONS.values()
        for pipeline in PIPELINES
    }
    adjusted = holm([random["lead_p"] for _, random in cells.values()])
    written = {
        key: [share(fixation["accuracy"]), lead_in_both(random, "lead", p_value)]
        for (key, (fixation, random)), p_value in zip(cells.items(), adjusted, strict=True)
    }
    rows = [
        [
            f"`{treatment}`",
            *(cell for pipeline in PIPELINES for cell in written[condition, pipeline]),
        ]
        for treatment, condition in CONDITIONS.items()
    ]
    heads = ["paper's pipeline: fixation", "ahead of random in sight by"]
    heads += ["ours: fixation", "ahead of random in sight by"]
    return table(["out of reach", *heads], rows)


def changes_sentence(sets: Mapping[str, Figures]) -> str:
    """Write which changes from `replace` have p below 0.05 after Holm's correction for all, and the views left out."""
    changes = list(_changes(sets))
    adjusted = holm([cell["p_value"] for *_, cell in changes])
    clear = [
        f"{SETS[name]}, `{pipeline}`, `{strategy}`, `{condition}`: {points(cell['difference'])}"
        for (name, pipeline, strategy, condition, cell), p_value in zip(
            changes, adjusted, strict=True
        )
        if p_value < SIGNIFICANCE
    ]
    text = (
        f"Of {len(changes)} changes of accuracy from `replace` to `skip` or `keep`, in pairs over objects, "
        f"{len(clear)} have p < {SIGNIFICANCE:g} after Holm's correction for all of them"
    )
    text += f" ({'; '.join(clear)})." if clear else "."
    left_out = [
        f"{views['as run'] - views['skip']} of {views['as run']:,} by `{strategy}` on {SETS[name]}"
        for name, kept in sets.items()
        for strategy, views in kept["views"].items()
        if views["skip"] < views["as run"]
    ]
    text += f" `skip` leaves out views without a place in reach: {', '.join(left_out) or 'none'}."
    measured = {f"{kept['date']}, commit {kept['commit']}" for kept in sets.values()}
    text += f" Measured on {' and '.join(sorted(measured))}."
    return textwrap.fill(text, 100, break_on_hyphens=False, break_long_words=False)


def blocks() -> dict[str, str]:
    """Return the blocks of the page by name."""
    sets = kept_figures(KEPT)
    return {
        "shares": shares_table(open_parquet(RANKS).read()),
        "accuracies": accuracies_table(sets["benchmark"]),
        "changes": changes_sentence(sets),
    }


def _changes(sets: Mapping[str, Figures]) -> Iterator[tuple[str, str, str, str, Figures]]:
    for name, kept in sets.items():
        for pipeline in PIPELINES:
            for strategy in STRATEGIES:
                for condition in ("skip", "keep"):
                    yield (
                        name,
                        pipeline,
                        strategy,
                        condition,
                        _cell(kept, pipeline, strategy, condition),
                    )


def _cell(kept: Figures, pipeline: str, strategy: str, condition: str) -> Figures:
    (by_condition,) = kept["figures"][pipeline][strategy].values()
    return by_condition[condition]


if __name__ == "__main__":
    fill_page(PAGE, blocks())
