"""Why jobs would run (`make why`), and whether what is there is what would be made (`make verify`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from visuohaptic_workflow.keys import Keys

ASKED = "VISUOHAPTIC_ASKED"
"""The variable of the environment by which the Snakefile is asked one of both, instead of running anything."""

_MOST_LINES = 11


def why(keys: Keys, targets: Iterable[str]) -> Iterator[str]:
    """Say in a few lines which jobs behind some files would run, by reason."""
    by_reason: dict[str, Counter[str]] = {}
    for record in keys.needed_for(targets):
        if reason := keys.why(record):
            by_reason.setdefault(reason, Counter())[keys.jobs[record].rule] += 1
    if not by_reason:
        yield "Nothing to be done."
    lines = sorted(by_reason.items(), key=lambda entry: -entry[1].total())
    for reason, rules in lines[:_MOST_LINES]:
        yield f"{reason}: {', '.join(f'{count} {rule}' for rule, count in rules.items())}"
    if rest := lines[_MOST_LINES:]:
        yield f"{len(rest)} more reasons: {sum(rules.total() for _, rules in rest)} jobs"


def verify(keys: Keys) -> tuple[list[str], bool]:
    """Return one line per record that does not fit, a line with their number, and whether every record fits."""
    there = {record: keys.reason(record) for record in keys.jobs if Path(record).exists()}
    wrong = [f"{record}: {reason}" for record, reason in there.items() if reason]
    today = "today's parameters, code, packages and meshes"
    count = (
        f"{len(wrong)} of {len(there)} records do not fit {today}."
        if wrong
        else f"All {len(there)} records fit {today}."
    )
    return [*wrong, count], not wrong
