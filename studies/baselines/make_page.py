"""Fill the tables of README.md from the kept accuracies: `make readme` and `make baselines`."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from filling import SETS, fill_page, table

from baselines.choose import CHOSEN
from baselines.measure import LENGTHS, OURS, STRATEGIES, KeptBaselines, KeptCell, read_kept
from visuohaptic.evaluation.intervals import Interval, compare_paired, object_interval
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.wording import percent, points, strategy_name

PAGE = Path(__file__).parent / "README.md"
LABELS = {
    OURS: "ours: linear discriminant on descriptors",
    "nearest_object": "nearest object by density of touches",
    "touch_perceptron": "multilayer perceptron of touches",
    "twenty_lines": "twenty lines: discriminant on means of touches",
    "paper": "the paper's: SVM on 60 features",
}
INTERVALS = IntervalParameters()
HEADLINE_TOUCHES = LENGTHS[0]
NOT_MEASURED = "not measured"

Cells = Mapping[tuple[str, str, int], KeptCell]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    kept = {name: read_kept(name) for name in SETS}
    strategies = [f"{strategy_name(name)} (`{name}`)" for name in STRATEGIES]
    heads = ["objects", "classifier", *strategies]
    accuracies = {
        length: table(
            heads, [row for of_set in kept.values() for row in _accuracies(of_set, length)]
        )
        for length in LENGTHS
    }
    differences = [row for of_set in kept.values() for row in _differences(of_set)]
    seconds = ["objects", "classifier", "splits"]
    seconds += [f"{kind}, {length}" for kind in ("fit", "predict") for length in LENGTHS]
    sources = "; ".join(
        f"{SETS[name]}: {of_set.source.commit[:12]}, {of_set.source.date}"
        for name, of_set in kept.items()
    )
    return {
        "headline": headline(kept),
        "simplest": simplest(kept),
        **{f"touches_{length}": text for length, text in accuracies.items()},
        "differences": table(
            ["held-out objects", "baseline minus ours", "touches", *strategies], differences
        ),
        "seconds": table(seconds, [row for of_set in kept.values() for row in _seconds(of_set)]),
        "chosen": table(
            ["classifier", "settings", "accuracy on the tuning objects"], list(_chosen())
        ),
        "sources": _wrapped(f"Measured once and kept; {sources}."),
    }


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
    lines = [_wrapped(f"- {_lead(*lead)}.", "  ") for lead in ahead or closest]
    level = [_level(of_set, baselines) for of_set in kept.values()]
    return "\n".join([_wrapped(first), "", *lines, "", *filter(None, level)])


def simplest(kept: Mapping[str, KeptBaselines], strategy: str = "random") -> str:
    """Write the accuracy of the twenty lines beside both pipelines, and whether they are ahead of the paper's."""
    lines = []
    for name, of_set in kept.items():
        cells = _by_name(of_set)
        simple, paper, ours = (
            percent(_accuracy(cells[classifier, strategy, HEADLINE_TOUCHES]).mean)
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
            f"are {verdict} the paper's pipeline: {_text(lead, points)} points."
        )
    start = f"**The simplest classifier** of five touches at random places in reach (`{strategy}`):"
    return "\n".join([_wrapped(start), "", *(_wrapped(_spaced(line), "  ") for line in lines)])


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


def _spaced(text: str) -> str:
    return text.replace("\N{NO-BREAK SPACE}", " ")


def _level(kept: KeptBaselines, names: Sequence[str]) -> str:
    """Write the baselines whose paired intervals contain 0 for all strategies; empty if there are none."""
    labels = []
    for name in names:
        if any((name, strategy, HEADLINE_TOUCHES) not in _by_name(kept) for strategy in STRATEGIES):
            continue
        intervals = [difference(kept, name, strategy, HEADLINE_TOUCHES) for strategy in STRATEGIES]
        if all(interval.low <= 0 <= interval.high for interval in intervals):
            labels.append(LABELS[name])
    if not labels:
        return ""
    count = len(kept.objects) - len(kept.choosing)
    return _wrapped(
        f"On {count} objects the intervals of all three strategies include 0: {', '.join(labels)}."
    )


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


def _accuracies(kept: KeptBaselines, touches: int) -> Iterator[list[object]]:
    cells = _by_name(kept)
    for name, label in LABELS.items():
        own = [cells.get((name, strategy, touches)) for strategy in STRATEGIES]
        texts = [_text(_accuracy(cell), percent) if cell else NOT_MEASURED for cell in own]
        yield [len(kept.objects), label, *texts]


def _accuracy(cell: KeptCell) -> Interval:
    rows = [pair for pair in zip(cell.accuracy, cell.weights, strict=True) if pair[0] is not None]
    values, weights = np.array(rows, dtype=np.float64).T
    return object_interval(values, weights, INTERVALS)


def _differences(kept: KeptBaselines) -> Iterator[list[object]]:
    reporting = len(kept.objects) - len(kept.choosing)
    for touches in LENGTHS:
        for name, label in LABELS.items():
            if name != OURS:
                texts = [
                    _text(difference(kept, name, strategy, touches), points)
                    if (name, strategy, touches) in _by_name(kept)
                    else NOT_MEASURED
                    for strategy in STRATEGIES
                ]
                yield [reporting, label, touches, *texts]


def _seconds(kept: KeptBaselines) -> Iterator[list[object]]:
    cells = _by_name(kept)
    for name, label in LABELS.items():
        own = [cells[name, STRATEGIES[0], length] for length in LENGTHS]
        times = [*(cell.fit for cell in own), *(cell.predict for cell in own)]
        yield [len(kept.objects), label, own[0].splits, *(f"{time:.2g} s" for time in times)]


def _chosen() -> Iterator[list[object]]:
    for name, choice in json.loads(CHOSEN.read_text(encoding="utf-8")).items():
        settings = ", ".join(f"{key} {value}" for key, value in choice["settings"].items())
        accuracy = choice["accuracy"][json.dumps(choice["settings"])]
        yield [LABELS[name], settings, _plain(percent(accuracy))]


def _lead(lead: Interval, name: str, strategy: str, kept: KeptBaselines) -> str:
    reporting = len(kept.objects) - len(kept.choosing)
    return f"{LABELS[name]}, {strategy_name(strategy)}, {reporting} objects: {_text(lead, points)}"


def _by_name(kept: KeptBaselines) -> Cells:
    return {(cell.classifier, cell.strategy, cell.touches): cell for cell in kept.cells}


def _text(interval: Interval, write: Callable[[float], str]) -> str:
    ends = f"{write(interval.low)} to {write(interval.high)}"
    return _plain(f"{write(interval.mean)} ({ends})")


def _wrapped(text: str, indent: str = "") -> str:
    return textwrap.fill(text, 100, subsequent_indent=indent, break_on_hyphens=False)


def _plain(text: str) -> str:
    return text.replace("\N{NO-BREAK SPACE}", " ")


if __name__ == "__main__":
    fill_page(PAGE, blocks())
