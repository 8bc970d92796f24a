"""Print one line per finished job of a run: what the job did, its seconds, and about how long the rest takes.

The lines come from the events that Snakemake's logger sends (`snakemake_interface_logger_plugins.common.LogEvent`). A
logger plugin would have to be installed before Snakemake reads its profile, and a profile that names a missing plugin
lets no job run. So the main process adds filters of Python's `logging` to the logger, and any environment that can run
the workflow shows the lines.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from snakemake_interface_logger_plugins.common import LogEvent

from visuohaptic.io.interrupts import STOPPED

# Ends of Snakemake's error about a job that Ctrl-C stopped.
_STOPPED_JOB = (f"exit status {STOPPED}.", "died with <Signals.SIGINT: 2>.")
_REPLACED = {LogEvent.JOB_STARTED, LogEvent.JOB_FINISHED}
_SELECTION = "Select jobs to execute..."
_NOTHING = "Nothing to be done ("


@dataclass(frozen=True)
class _Job:
    """A job that runs: its words, the time of its start (s), and whether it does anything."""

    words: str
    start: float
    works: bool


class _JobLines:
    """Filters that replace Snakemake's lines on jobs in one stream; other streams and files keep them."""

    def __init__(
        self,
        stream: logging.Handler,
        words_of: Callable[[str, Mapping[str, str]], str],
        report_at_end: Callable[[], str | None],
    ) -> None:
        self._stream = stream
        self._words_of = words_of
        self._report_at_end = report_at_end
        self._jobs: dict[int, _Job] = {}
        self._finished: list[tuple[_Job, float]] = []
        self._is_stopped = False

    def read(self, record: logging.LogRecord) -> bool:
        """Read jobs that start and fail. Snakemake's option ``quiet`` hides these events only from the stream."""
        event = getattr(record, "event", None)
        if event == LogEvent.JOB_INFO:
            fields = vars(record)
            words = self._words_of(
                fields.get("rule_msg") or fields["rule_name"], fields.get("wildcards") or {}
            )
            self._jobs[fields["jobid"]] = _Job(words, record.created, bool(fields.get("rule_msg")))
        elif event == LogEvent.ERROR and str(record.msg).endswith(_STOPPED_JOB):
            self._is_stopped = True
        elif event == LogEvent.JOB_ERROR and not self._is_stopped:
            job = self._jobs.get(vars(record)["jobid"])
            self._print(f"failed: {job.words if job else record.getMessage()}", logging.ERROR)
        return True

    def replace(self, record: logging.LogRecord) -> bool:
        """Print a line for each finished job, and return whether Snakemake prints the record itself."""
        event, message = getattr(record, "event", None), str(record.msg)
        if event == LogEvent.JOB_FINISHED and (job := self._jobs.get(vars(record)["job_id"])):
            self._finished.append((job, record.created))
        if event == LogEvent.PROGRESS:
            self._print_finished(vars(record)["done"], vars(record)["total"])
            return False
        if event is not None:
            return event not in _REPLACED and not message.endswith(_STOPPED_JOB)
        if message.startswith(_NOTHING) and (report := self._report_at_end()):
            self._print(f"Nothing to be done; the report is at {report}.")
            return False
        return message != _SELECTION

    def _print_finished(self, done: int, total: int) -> None:
        first = done - len(self._finished) + 1
        for count, (job, end) in enumerate(self._finished, first):
            line = f"[{count} of {total}] {job.words}"
            if job.works:
                line += f": {end - job.start:.0f} s"
            if count < total:
                elapsed = end - min(job.start for job in self._jobs.values())
                line += f"; {spoken_time(elapsed * (total - count) / count)} left"
            self._print(line)
        self._finished.clear()

    def _print(self, line: str, level: int = logging.INFO) -> None:
        """Send a line to the stream, with its filters and colours."""
        name = logging.getLevelName(level)
        self._stream.handle(
            logging.makeLogRecord({"msg": line, "levelno": level, "levelname": name})
        )


def show_job_lines(
    logger: logging.Logger,
    words_of: Callable[[str, Mapping[str, str]], str],
    report_at_end: Callable[[], str | None],
) -> None:
    """Replace Snakemake's lines on jobs by one line per finished job, wherever Snakemake prints to a stream.

    With option ``--verbose`` all lines stay. Options ``--quiet`` and ``--logger`` hide or replace the lines as they do
    with Snakemake's own.

    Parameters
    ----------
    logger : logging.Logger
        Snakemake's logger, ``logger`` in a Snakefile.
    words_of : callable
        Returns what a job does from the message, or else name, of its rule, and its wildcards.
    report_at_end : callable
        Returns the path of the report if this run asks for the report and finds it current; otherwise None.
    """
    if logger.isEnabledFor(logging.DEBUG):
        return
    for handler in list(logger.handlers):
        if isinstance(handler, logging.StreamHandler) and not isinstance(
            handler, logging.FileHandler
        ):
            lines = _JobLines(handler, words_of, report_at_end)
            logger.addFilter(lines.read)
            handler.addFilter(lines.replace)


def spoken_time(seconds: float) -> str:
    """Return a duration with one or two digits, such as ``some 40 s`` or ``some 3 min``."""
    if seconds < 10:
        return f"some {max(seconds, 1):.0f} s"
    if seconds < 95:
        return f"some {10 * round(seconds / 10)} s"
    if seconds < 5700:
        return f"some {seconds / 60:.0f} min"
    return f"some {seconds / 3600:.1f} h"
