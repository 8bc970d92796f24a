"""The logs that jobs of a workflow leave: how long each job took."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

SECONDS = "seconds:"
"""Start of the line that ends the log of a finished job."""


@dataclass(frozen=True)
class JobSeconds:
    """What one job took: `imports` from the process's start to the work, and the `work`, in s."""

    imports: float
    work: float


def read_seconds(log: str | Path) -> JobSeconds | None:
    """Read from a log what its job took; None where the job did not finish."""
    for line in Path(log).read_text(encoding="utf-8").splitlines():
        if line.startswith(SECONDS):
            _, _, imports, _, work = line.split()
            return JobSeconds(float(imports), float(work))
    return None
