"""Fill README.md and draw its picture from the kept accuracies: `make readme` and `make baselines`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from filling import SETS, fill_page, measured, plain, resized, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from baselines.measure import LENGTHS, OURS, STRATEGIES, KeptBaselines, KeptCell, read_kept
from visuohaptic.evaluation.intervals import Interval, compare_paired, object_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import estimate, with_interval
from visuohaptic.report.figures import Series, draw_leads
from visuohaptic.report.wording import points, strategy_name, strategy_place

PAGE = Path(__file__).parent / "README.md"
PICTURE = PAGE.with_name("baselines.png")
LABELS = {
    OURS: "ours: linear discriminant on descriptors",
    "nearest_object": "nearest object by density of touches",
    "touch_perceptron": "multilayer perceptron of touches",
    "twenty_lines": "twenty lines: discriminant on means of touches",
    "paper": "the paper's: SVM on 60 features",
}
INTERVALS = IntervalParameters()
HEADLINE_TOUCHES = LENGTHS[0]

Cells = Mapping[tuple[str, str, int], KeptCell]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    kept = {name: read_kept(name) for name in SETS}
    return {
        "headline": headline(kept),
        "simplest": simplest(kept),
        "accuracies": accuracy_table(kept["benchmark"], kept["paper"]),
        "sources": measured(PAGE.parent),
    }


def accuracy_table(many: KeptBaselines, few: KeptBaselines) -> str:
    """Return the accuracies and the seconds of a fit of each classifier."""
    shown = [(many, strategy, HEADLINE_TOUCHES) for strategy in STRATEGIES]
    shown += [(many, "random", LENGTHS[-1]), (few, "random", HEADLINE_TOUCHES)]
    heads = ["classifier", *(f"`{strategy}`" for strategy in STRATEGIES)]
    heads += [f"`random`, {LENGTHS[-1]} touch", f"`random`, {len(few.objects)} objects"]
    rows = []
    for name, label in LABELS.items():
        cells = [_by_name(kept)[name, strategy, touches] for kept, strategy, touches in shown]
        rows.append([label, *map(_accuracy_text, cells), f"{cells[0].fit:.2g} s"])
    return table([*heads, "fit"], rows)


def draw(kept: KeptBaselines) -> Figure:
    """Draw each baseline minus ours at five touches, one mark per strategy."""
    baselines = [name for name in LABELS if name != OURS]
    series = [
        Series(
            strategy_name(strategy),
            strategy_place(strategy),
            [estimate(difference(kept, name, strategy, HEADLINE_TOUCHES)) for name in baselines],
        )
        for strategy in STRATEGIES
    ]
    return resized(draw_leads([LABELS[name] for name in baselines], "baseline", series), 330)


def headline(kept: Mapping[str, KeptBaselines]) -> str:
    """Write whether a baseline is ahead of pipeline `order_free` at five touches, or else which baseline is closest."""
    baselines = [name for name in LABELS if name != OURS]
    leads_of_sets = [
        [
            (difference(of_set, name, strategy, HEADLINE_TOUCHES), name, strategy, of_set)
            for name in baselines
            for strategy in STRATEGIES
            if (name, strategy, HEADLINE_TOUCHES) in _by_name(of_set)
        ]
        for of_set in kept.values()
    ]
    ahead = [lead for leads in leads_of_sets for lead in leads if lead[0].low > 0]
    if ahead:
        first = "**A baseline is significantly better than our pipeline at five touches**, with a paired interval above 0:"
    else:
        first = (
            "**No baseline is significantly better than our pipeline at five touches** on the held-out objects: "
            "no paired interval lies above 0. The largest mean differences, baseline minus ours in percentage points:"
        )
    closest = [max(leads, key=lambda lead: lead[0].mean) for leads in leads_of_sets]
    lines = [wrapped(f"- {_lead(*lead)}.", "  ") for lead in ahead or closest]
    return "\n".join([wrapped(first), "", *lines])


def simplest(kept: Mapping[str, KeptBaselines], strategy: str = "random") -> str:
    """Write the accuracy of the twenty lines beside both pipelines, and whether they are ahead of the paper's."""
    lines = []
    for name, of_set in kept.items():
        cells = _by_name(of_set)
        simple, paper, ours = (
            _accuracy_text(cells[classifier, strategy, HEADLINE_TOUCHES])
            for classifier in ("twenty_lines", "paper", OURS)
        )
        lead = _gap(of_set, "twenty_lines", "paper", strategy)
        verdict = (
            "ahead of"
            if lead.low > 0
            else "behind"
            if lead.high < 0
            else "not shown to differ from"
        )
        lines.append(
            f"- {SETS[name]}: {simple} by twenty lines, {paper} by the paper's pipeline, {ours} by ours. Twenty lines "
            f"are {verdict} the paper's: {_points(lead)} points."
        )
    start = f"**The simplest classifier** of five touches at random places in reach (`{strategy}`):"
    return "\n".join([wrapped(start), "", *(wrapped(line, "  ") for line in lines)])


def _gap(kept: KeptBaselines, first: str, second: str, strategy: str) -> Interval:
    """Compute the accuracy of one classifier minus that of another, paired over all objects, by five touches."""
    cells = _by_name(kept)
    one, other = (cells[name, strategy, HEADLINE_TOUCHES] for name in (first, second))
    rows = [
        row
        for row in zip(one.accuracy, other.accuracy, other.weights, strict=True)
        if None not in row
    ]
    values, others, weights = np.array(rows, dtype=np.float64).T
    return compare_paired(values, others, weights, INTERVALS).difference


def difference(kept: KeptBaselines, name: str, strategy: str, touches: int) -> Interval:
    """Compute the accuracy of a baseline minus that of `OURS`, paired over objects outside of `kept.choosing`."""
    cells = _by_name(kept)
    own, other = (cells[classifier, strategy, touches] for classifier in (OURS, name))
    rows = [
        (theirs, ours, weight)
        for key, theirs, ours, weight in zip(
            kept.objects, other.accuracy, own.accuracy, own.weights, strict=True
        )
        if key not in kept.choosing and theirs is not None and ours is not None
    ]
    theirs, ours, weights = np.array(rows, dtype=np.float64).T
    return compare_paired(theirs, ours, weights, INTERVALS).difference


def _accuracy(cell: KeptCell) -> Interval:
    rows = [pair for pair in zip(cell.accuracy, cell.weights, strict=True) if pair[0] is not None]
    values, weights = np.array(rows, dtype=np.float64).T
    return object_interval(values, weights, INTERVALS)


def _accuracy_text(cell: KeptCell) -> str:
    return share(_accuracy(cell).mean)


def _lead(lead: Interval, name: str, strategy: str, kept: KeptBaselines) -> str:
    reporting = len(kept.objects) - len(kept.choosing)
    return f"{LABELS[name]}, {strategy_name(strategy)}, {reporting} objects: {_points(lead)}"


def _points(interval: Interval) -> str:
    return plain(with_interval(estimate(interval), points))


def _by_name(kept: KeptBaselines) -> Cells:
    return {(cell.classifier, cell.strategy, cell.touches): cell for cell in kept.cells}


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(read_kept("benchmark")), PICTURE)
