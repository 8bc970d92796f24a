"""From a run's tables to the report's file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.objects import Track
from visuohaptic.report.page import render_page
from visuohaptic.report.run import RunFiles, read_run


def make_report(
    files: RunFiles,
    output: str | Path,
    parameters: ExperimentParameters,
    objects: Sequence[str],
    processes: int = 1,
    track: Track = iter,
) -> None:
    """Write the report of a run, whole or not at all.

    Parameters
    ----------
    files : RunFiles
        Where the run's tables lie.
    output : path
        The HTML file; its folder is made where missing.
    parameters : ExperimentParameters
        What was run.
    objects : sequence of str
        Objects that were to take part, `class/name`; those of which there is no
        table are named in a warning.
    processes : int
        Processes to work on, at most; they change nothing but the time.
    track : callable
        Takes the objects' names and gives them back one by one, as a progress bar does.

    Raises
    ------
    ReportError
        If the metrics can't be read.
    TableError
        If a table is missing or breaks its schema.
    """
    page = render_page(read_run(files, parameters, objects), processes, track)
    output = Path(output)
    output.parent.mkdir(parents=True, exist_ok=True)
    waiting = output.with_name(f".{output.name}.part")
    try:
        waiting.write_text(page, encoding="utf-8")
        waiting.replace(output)
    finally:
        waiting.unlink(missing_ok=True)
