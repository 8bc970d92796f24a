"""Snakemake with a short screen instead of its log: progress, failed jobs, and at the end what came out.

`python -m visuohaptic_workflow.screen …` takes Snakemake's options, and ends with its status.
Snakemake's whole log is in a file, which the screen names.
"""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

from visuohaptic.interrupts import CLEAR_LINE, STOPPED
from visuohaptic_workflow.stopping import end_at_ctrl_c

NEXT = """\
What else can be asked, after `source .venv/bin/activate`:
  snakemake -n                        what would run now, and why
  snakemake -j2 cost_all              accuracy against time; also curves_all, ablations_all, effects_all, readings_all
  snakemake -j2 study_palm_size       your own study (studies/README.md)
  snakemake -j2 model_all             a model for `visuohaptic recognise mug.obj`, a mesh of your own
  visuohaptic touch mug.obj           looks at a mesh and touches it; also compare"""

_LOGGER = "screen"
_BAR = 24
_STEPS = 10
"""Lines about progress where there is no terminal."""


@dataclass
class Screen:
    """What is shown of a run.

    Attributes
    ----------
    failed : list of str
        Failed jobs, each with the path of its log.
    wrote_report : bool
        Whether the report was among the jobs.
    """

    failed: list[str] = field(default_factory=list)
    wrote_report: bool = False
    _jobs: dict[int, str] = field(default_factory=dict)
    _is_bar_shown: bool = False
    _steps_shown: int = 0
    _started: float = field(default_factory=time.monotonic)

    def show(self, record: logging.LogRecord) -> None:
        """Show what Snakemake logs, as far as a user needs it at once."""
        event = str(getattr(record, "event", ""))
        if event == "job_info":
            self.wrote_report |= record.__dict__["rule_name"] == "report"
            self._jobs[record.__dict__["jobid"]] = (
                record.__dict__["rule_msg"] or record.__dict__["rule_name"]
            )
        elif event == "progress":
            self._show_progress(record.__dict__["done"], record.__dict__["total"])
        elif event == "job_error":
            self._note_failure(record)
        elif record.levelno >= logging.WARNING and not _is_said_elsewhere(record):
            self.say(record.getMessage().strip())

    def say(self, *lines: str) -> None:
        """Print lines below those that are there."""
        clear = CLEAR_LINE if self._is_bar_shown else ""
        self._is_bar_shown = False
        sys.stderr.write(clear + "".join(f"{line}\n" for line in lines))
        sys.stderr.flush()

    def _note_failure(self, record: logging.LogRecord) -> None:
        job = self._jobs.get(record.__dict__["jobid"], record.__dict__["rule_name"])
        logs = ", ".join(record.__dict__["log"]) or "no log"
        self.failed.append(f"{job}: {logs}")

    def _show_progress(self, done: int, total: int) -> None:
        seconds = f"{time.monotonic() - self._started:.0f} s"
        if sys.stderr.isatty():
            filled = "#" * (_BAR * done // total)
            # Back to the line's start, so that a job's error does not begin behind the bar.
            sys.stderr.write(f"{CLEAR_LINE}[{filled:.<{_BAR}}] {done} of {total} jobs, {seconds}\r")
            sys.stderr.flush()
            self._is_bar_shown = True
        elif (step := _STEPS * done // total) > self._steps_shown:
            self._steps_shown = step
            self.say(f"{done} of {total} jobs, {seconds}")


def _is_said_elsewhere(record: logging.LogRecord) -> bool:
    """Whether a message only repeats that a job failed, which has said so itself."""
    return (
        getattr(record, "exception", "") == "RuleException"
        or "CalledProcessError" in record.getMessage()
        or "At least one job did not complete successfully" in record.getMessage()
        or "Exiting because a job execution failed" in record.getMessage()
    )


def _make_plugin(screen: Screen) -> ModuleType:
    """Make a logger plugin of Snakemake that shows its log on a screen."""
    from snakemake_interface_logger_plugins.base import LogHandlerBase

    class LogHandler(LogHandlerBase):
        writes_to_stream = True
        writes_to_file = False
        has_filter = True
        has_formatter = True
        needs_rulegraph = False

        def emit(self, record: logging.LogRecord) -> None:
            screen.show(record)

    plugin = ModuleType(_LOGGER)
    plugin.LogHandler = LogHandler  # type: ignore[attr-defined]
    return plugin


def _run_snakemake(screen: Screen, arguments: Iterable[str]) -> int:
    """Run Snakemake in this process, and give its status."""
    from snakemake.cli import main as snakemake
    from snakemake_interface_logger_plugins.registry import LoggerPluginRegistry

    LoggerPluginRegistry().register_plugin(_LOGGER, _make_plugin(screen))
    sys.argv = ["snakemake", "--logger", _LOGGER, *arguments]
    try:
        snakemake()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(bool(end.code))
    return 0


def _newest_log(since: float) -> str | None:
    logs = [log for log in Path(".snakemake/log").glob("*.log") if log.stat().st_mtime >= since]
    return str(max(logs, default=None)) if logs else None


def main() -> None:
    """Run Snakemake with what the command line says; see the module."""
    end_at_ctrl_c()
    started = time.time()
    screen = Screen()
    arguments = sys.argv[1:]
    status = _run_snakemake(screen, arguments)
    if status != STOPPED:
        _say_end(screen, status, _newest_log(started), arguments)
    raise SystemExit(status)


def _targets(arguments: Sequence[str]) -> Collection[str]:
    """Give the targets that a command line of Snakemake names."""
    from snakemake.cli import get_argument_parser

    return get_argument_parser().parse_args(list(arguments)).targets


def _say_end(screen: Screen, status: int, log: str | None, arguments: Sequence[str]) -> None:
    if status == 0:
        from visuohaptic_workflow.closing import lines_at_end

        # Without targets everything was made, or was up to date.
        is_current = screen.wrote_report or not _targets(arguments)
        screen.say("", *lines_at_end(report_is_current=is_current))
    if screen.failed:
        screen.say(f"{len(screen.failed)} failed, the reason is in its log:", *screen.failed)
    if log:
        screen.say(f"Snakemake's log is {log}.")
    if status == 0:
        screen.say(NEXT)


if __name__ == "__main__":
    main()
