"""Logs of the jobs of a workflow: how long each job took."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

SECONDS = "seconds:"
"""Start of the line that ends the log of a finished job."""


@dataclass(frozen=True)
class JobSeconds:
    """Seconds of one job: `imports` from the start of the process to the start of the work, and `work`."""

    imports: float
    work: float


def read_seconds(log: str | Path) -> JobSeconds | None:
    """Read the seconds of a job from its log; None if the job did not finish."""
    for line in Path(log).read_text(encoding="utf-8").splitlines():
        if line.startswith(SECONDS):
            _, _, imports, _, work = line.split()
            return JobSeconds(float(imports), float(work))
    return None
