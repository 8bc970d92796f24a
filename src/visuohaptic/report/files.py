"""From a run's tables to the report's file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.objects import Track
from visuohaptic.report.page import render_page
from visuohaptic.report.run import RunFiles, read_run
from visuohaptic.whole_files import write_whole


def make_report(
    files: RunFiles,
    output: str | Path,
    parameters: ExperimentParameters,
    objects: Sequence[str],
    processes: int = 1,
    track: Track = iter,
) -> None:
    """Write the report of a run, completely or not at all."""
    page = render_page(read_run(files, parameters, objects), processes, track)
    write_whole(output, page)
