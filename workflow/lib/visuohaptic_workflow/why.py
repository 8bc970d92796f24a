"""List the reasons why jobs would run (`make why`), and records that are not current (`make verify`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from visuohaptic_workflow.keys import Keys

_MOST_LINES = 11


def why(keys: Keys, targets: Iterable[str], former: Sequence[str] = ()) -> Iterator[str]:
    """Yield at most a few lines: the jobs behind some files that would run, by reason, and how many files are `former`.

    `former` are files of former jobs, which the next run moves aside (`former_files.find_former_files`).
    """
    by_reason: dict[str, Counter[str]] = {}
    for record in keys.needed_for(targets):
        if reason := keys.reason_to_run(record):
            by_reason.setdefault(reason, Counter())[keys.jobs[record].rule] += 1
    if not by_reason and not former:
        yield "Nothing to be done."
    lines = sorted(by_reason.items(), key=lambda entry: -entry[1].total())
    for reason, rules in lines[:_MOST_LINES]:
        yield f"{reason}: {', '.join(f'{count} {rule}' for rule, count in rules.items())}"
    if rest := lines[_MOST_LINES:]:
        yield f"{len(rest)} more reasons: {sum(rules.total() for _, rules in rest)} jobs"
    yield from _former_line(former)


def verify(keys: Keys, former: Sequence[str] = ()) -> tuple[list[str], bool]:
    """Return one line per record that is not current, lines with numbers, and whether all is current.

    Files of former jobs, `former`, are not current.
    """
    reasons = {
        record: keys.reason_not_current(record) for record in keys.jobs if Path(record).exists()
    }
    stale = [f"{record}: {reason}" for record, reason in reasons.items() if reason]
    today = "today's parameters, code, packages and meshes"
    count = (
        f"{len(stale)} of {len(reasons)} records do not fit {today}."
        if stale
        else f"All {len(reasons)} records fit {today}."
    )
    return [*stale, *_former_line(former), count], not (stale or former)


def _former_line(former: Sequence[str]) -> list[str]:
    """Return a line on files of former jobs; no line without such files."""
    if not former:
        return []
    return [
        f"{len(former)} files of former jobs, such as {former[0]}: the next run moves them aside."
    ]
