"""Logs of the jobs of a workflow: how long each job took, and its warnings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

SECONDS = "seconds:"
"""Start of the line that ends the log of a finished job."""
WARNING = "warning:"
"""Start of a line with a warning of a job."""


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


def read_warnings(logs: Iterable[str | Path]) -> list[str]:
    """Read the lines with warnings of several logs, each line once, in the order of the logs; missing logs have none."""
    texts = (Path(log).read_text(encoding="utf-8") for log in logs if Path(log).is_file())
    lines = (line for text in texts for line in text.splitlines() if line.startswith(WARNING))
    return list(dict.fromkeys(lines))
