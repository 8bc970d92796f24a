"""List the reasons why jobs would run (`make why`), and records that are not current (`make verify`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from visuohaptic_workflow.keys import Keys
from visuohaptic_workflow.sweeping import ASIDE, STORE, Sweep

_MOST_LINES = 11
_OF_THE_NEXT_RUN = ("The next run will move", "The next run will bring")
_TODAY = "today's parameters, code, packages and meshes"


def why(
    keys: Keys, targets: Iterable[str], sweep: Sweep, left_out: Sequence[str] = ()
) -> Iterator[str]:
    """Yield at most a few lines: the jobs behind some files that would run, by reason, and what the next run moves.

    `left_out` are sentences on studies that leave the report (`studies_asked.say_left_out`).
    """
    by_reason: dict[str, Counter[str]] = {}
    for record in keys.needed_for(targets, sweep.stale):
        by_reason.setdefault(sweep.stale[record], Counter())[keys.jobs[record].rule] += 1
    moves = lines_of_sweep(sweep, left_out, is_done=False)
    if not by_reason and not moves:
        yield "Nothing to be done."
    lines = sorted(by_reason.items(), key=lambda entry: -entry[1].total())
    for reason, rules in lines[:_MOST_LINES]:
        yield f"{reason}: {', '.join(f'{count} {rule}' for rule, count in rules.items())}"
    if rest := lines[_MOST_LINES:]:
        yield f"{len(rest)} more reasons: {sum(rules.total() for _, rules in rest)} jobs"
    yield from moves


def verify(keys: Keys, sweep: Sweep) -> tuple[list[str], bool]:
    """Return one line per record that is not current, lines on moves, and whether all is current."""
    reasons = {
        record: keys.reason_not_current(record) for record in keys.jobs if Path(record).exists()
    }
    stale = [f"{record}: {reason}" for record, reason in reasons.items() if reason]
    count = (
        f"{len(stale)} of {len(reasons)} records do not fit {_TODAY}."
        if stale
        else f"All {len(reasons)} records fit {_TODAY}."
    )
    moves = lines_of_sweep(sweep, is_done=False)
    return [*stale, *moves, count], not (stale or moves)


def lines_of_sweep(sweep: Sweep, left_out: Sequence[str] = (), *, is_done: bool) -> list[str]:
    """Return at most three lines on what a sweep moved, or what the sweep of the next run will move, then `left_out`."""
    move, bring = ("Moved", "Brought") if is_done else _OF_THE_NEXT_RUN
    lines = []
    if sweep.stored:
        lines.append(f"{move} {_files(sweep.stored.values(), 'former ')} to {STORE}.")
    if sweep.aside:
        tables = (file for file in sweep.aside if not file.endswith((".json", ".log")))
        example = next(tables, sweep.aside[0])
        files = f"{_files([sweep.aside])} without a fitting record, such as {example},"
        lines.append(f"{move} {files} to {ASIDE}.")
    if sweep.returned:
        lines.append(f"{bring} {_files(sweep.returned.values())} back from {STORE}.")
    return [*lines, *left_out]


def _files(groups: Iterable[Sequence[str]], kind: str = "") -> str:
    count = sum(map(len, groups))
    return f"{count:,} {kind}file{'s' * (count != 1)}"
