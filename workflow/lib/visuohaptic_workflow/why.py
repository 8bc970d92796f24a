"""Why jobs would run, and whether what is there is what would be made: `python -m visuohaptic_workflow.why [verify]`.

Snakemake reads the Snakefile, which then answers instead of running anything (`answer`); nothing is written.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from visuohaptic_workflow.keys import Keys

ASKED = "VISUOHAPTIC_ASKED"
"""The variable of the environment that names the file for the answer."""

_MOST_LINES = 11


def answer(keys: Keys, targets: Iterable[str]) -> None:
    """Write the reasons of all jobs behind some files, and of all that have left a record, if somebody asked."""
    path = os.environ.get(ASKED)
    if path is None:
        return
    needed = [[keys.jobs[name].rule, keys.reason(name)] for name in keys.needed_for(targets)]
    there = {name: keys.reason(name) for name in keys.jobs if Path(name).exists()}
    Path(path).write_text(json.dumps({"needed": needed, "there": there}), encoding="utf-8")


def why(needed: Iterable[tuple[str, str | None]]) -> Iterator[str]:
    """Say in a few lines which jobs would run, by reason."""
    by_reason: dict[str, Counter[str]] = {}
    for rule, reason in needed:
        if reason is not None:
            by_reason.setdefault(reason, Counter())[rule] += 1
    if not by_reason:
        yield "Nothing to be done."
    lines = sorted(by_reason.items(), key=lambda entry: -entry[1].total())
    for reason, rules in lines[:_MOST_LINES]:
        yield f"{reason}: {', '.join(f'{count} {rule}' for rule, count in rules.items())}"
    if rest := lines[_MOST_LINES:]:
        yield f"{len(rest)} more reasons: {sum(rules.total() for _, rules in rest)} jobs"


def main() -> None:
    """Ask, and print the answer; `verify` ends with 1 if a file is not what would be made today."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "answer.json"
        asked = subprocess.run(
            [sys.executable, "-m", "snakemake", "--list-rules", "--quiet"],
            env={**os.environ, ASKED: str(path)}, text=True, check=False,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
        if not path.exists():
            sys.exit(asked.stdout)
        found = json.loads(path.read_text(encoding="utf-8"))
    if sys.argv[1:] != ["verify"]:
        _say(*why(found["needed"]))
        return
    wrong = {name: reason for name, reason in found["there"].items() if reason}
    _say(*(f"{name}: {reason}" for name, reason in wrong.items()))
    _say(f"{len(found['there'])} records, {len(wrong)} of which are not today's.")
    sys.exit(1 if wrong else 0)


def _say(*lines: str) -> None:
    sys.stdout.write("".join(f"{line}\n" for line in lines))


if __name__ == "__main__":
    main()
