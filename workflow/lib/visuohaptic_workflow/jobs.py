"""Run a job of the workflow: measure its time, write its log and record, and report errors in one sentence."""

from __future__ import annotations

import gc
import logging
import os
import shlex
import signal
import sys
import time
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

import psutil

from visuohaptic.base.atomic_files import storage_fault
from visuohaptic.base.errors import VisuohapticError
from visuohaptic.base.quick_imports import end_imports, keep_pandas_out
from visuohaptic.io.interrupts import STOPPED
from visuohaptic.io.job_logs import SECONDS, WARNING
from visuohaptic_workflow.one_run import hold_job_lock
from visuohaptic_workflow.records import check_inputs, check_unchanged, write_record


def set_job_environment(*folders: str | Path) -> None:
    """Put folders in front of the caller's PYTHONPATH for child processes.

    Child processes then import the package of this checkout, even if another version is installed.
    """
    inherited = without_studies_of_clones(os.environ.get("PYTHONPATH", "").split(os.pathsep))
    paths = dict.fromkeys([*map(str, folders), *filter(None, inherited)])
    os.environ["PYTHONPATH"] = os.pathsep.join(paths)


def make_python_a_shell_word() -> None:
    """Name Python by a word of the shell, if its path is none: Snakemake writes the path into commands without quotes.

    A path with a blank would end each job in "No such file or directory". The folder of Python becomes the first of
    `PATH`, so that the name without folder means the same Python.
    """
    if shlex.quote(sys.executable) == sys.executable:
        return
    folder, name = os.path.split(sys.executable)
    os.environ["PATH"] = os.pathsep.join([folder, *filter(None, [os.environ.get("PATH")])])
    sys.executable = name


def without_studies_of_clones(paths: Iterable[str]) -> list[str]:
    """Drop folders ``studies`` of clones from a search path: they would hide this clone's modules."""
    return [path for path in paths if not _is_studies_of_clone(Path(path))]


def _is_studies_of_clone(path: Path) -> bool:
    return path.name == "studies" and (path.parent / "workflow/Snakefile").is_file()


class _Warnings(logging.Handler):
    """Collects the warnings of a job, each once, as lines of the job's log."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._lines: dict[str, None] = {}

    @property
    def text(self) -> str:
        return "".join(self._lines)

    def emit(self, record: logging.LogRecord) -> None:
        self._lines[f"{WARNING} {' '.join(record.getMessage().split())}\n"] = None


@contextmanager
def job(snakemake: Any) -> Iterator[None]:
    """Run the body as the work of a job: check its inputs, and write its log and record.

    The log has the seconds and warnings that `visuohaptic.io.job_logs` reads. The run prints the warnings of its jobs at
    its end. After an error the process exits with status 1. A sentence and the warnings go to standard error and the log;
    the log also gets the traceback of an unexpected error. If the user stops the run, the process exits with status 130
    and prints nothing.
    """
    if signal.getsignal(signal.SIGINT) == signal.SIG_DFL:  # by `start_of_job`
        signal.signal(signal.SIGINT, signal.default_int_handler)
    end_imports()
    # Neither the work nor the end of the process looks through the imported modules again.
    gc.freeze()
    path = Path(snakemake.log[0])
    warnings = _Warnings()
    logging.getLogger().addHandler(warnings)
    try:
        hold_job_lock()
        path.parent.mkdir(parents=True, exist_ok=True)
        if "pyarrow" in sys.modules:
            keep_pandas_out()
        started = time.time()
        imports = _seconds_since_start()
        snapshot = snakemake.params.get("key")
        if snapshot:
            check_inputs(snapshot)
        yield
        if snapshot:
            check_unchanged(snapshot)
        write_record(snakemake, snapshot)
        work = time.time() - started
        done = f"done\n{SECONDS} imports {imports:.3f} work {work:.3f}\n"
        _write_log(path, f"{warnings.text}{done}")
    except KeyboardInterrupt:
        raise SystemExit(STOPPED) from None
    except VisuohapticError as error:
        _end_with(path, f"error: {error}", warnings.text)
    except Exception as error:  # noqa: BLE001 - the job ends here with the reason
        if _is_interrupted(error):
            # Open3D prints a list of its memory when a process ends in which its import was interrupted.
            os._exit(STOPPED)
        # Arrow, and a write to an open file, name no file.
        if fault := storage_fault(error, getattr(error, "filename", None) or snakemake.output[0]):
            _end_with(path, f"error: {fault}", warnings.text)
        sentence = f"error: {type(error).__name__}: {error} (see {path})"
        _end_with(path, sentence, warnings.text, traceback.format_exc())
    finally:
        logging.getLogger().removeHandler(warnings)


def _is_interrupted(error: BaseException | None) -> bool:
    """Return whether Ctrl-C is behind an error: an import of compiled code turns KeyboardInterrupt into ImportError."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


def _end_with(log: Path, sentence: str, warnings: str, details: str = "") -> NoReturn:
    """Print a sentence and warnings, write them with details to the log, and exit with status 1."""
    said = f"{sentence}\n{warnings}"
    sys.stderr.write(said)
    try:
        _write_log(log, f"{said}{details}")
    except OSError as error:  # the disk of the log is often the disk that failed
        sys.stderr.write(f"{error}\n{details}")
    raise SystemExit(1)


def _write_log(log: Path, text: str) -> None:
    try:
        log.write_text(text, encoding="utf-8")
    except OSError as error:
        if fault := storage_fault(error, log):
            raise fault from error
        raise


def _seconds_since_start() -> float:
    """Return the age of this process in seconds; the kernel counts hundredths."""
    if sys.platform == "linux":
        # Field 22 of 52. The name in field 2 may contain spaces and brackets.
        fields = Path("/proc/self/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return time.clock_gettime(time.CLOCK_BOOTTIME) - int(fields[19]) / os.sysconf("SC_CLK_TCK")
    return time.time() - psutil.Process().create_time()
