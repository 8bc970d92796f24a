"""List the reasons why jobs would run (`make why`), and records that are not current (`make verify`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from visuohaptic_workflow.keys import Keys

ASKED = "VISUOHAPTIC_ASKED"
"""The environment variable that makes the Snakefile answer `why`, `verify` or `lock` instead of running jobs."""

_MOST_LINES = 11


def why(keys: Keys, targets: Iterable[str]) -> Iterator[str]:
    """Yield at most a few lines: the jobs behind some files that would run, by reason."""
    by_reason: dict[str, Counter[str]] = {}
    for record in keys.needed_for(targets):
        if reason := keys.reason_to_run(record):
            by_reason.setdefault(reason, Counter())[keys.jobs[record].rule] += 1
    if not by_reason:
        yield "Nothing to be done."
    lines = sorted(by_reason.items(), key=lambda entry: -entry[1].total())
    for reason, rules in lines[:_MOST_LINES]:
        yield f"{reason}: {', '.join(f'{count} {rule}' for rule, count in rules.items())}"
    if rest := lines[_MOST_LINES:]:
        yield f"{len(rest)} more reasons: {sum(rules.total() for _, rules in rest)} jobs"


def verify(keys: Keys) -> tuple[list[str], bool]:
    """Return one line per record that is not current, a line with their number, and whether all are current."""
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
    return [*stale, count], not stale
