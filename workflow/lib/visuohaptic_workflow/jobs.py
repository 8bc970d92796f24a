"""What every job of a workflow needs around its work: a log, a clock, and errors in one sentence."""

from __future__ import annotations

import os
import sys
import time
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from visuohaptic.base.errors import VisuohapticError
from visuohaptic.base.optional_packages import allow_pandas, keep_pandas_out
from visuohaptic.io.interrupts import STOPPED
from visuohaptic.io.job_logs import SECONDS
from visuohaptic_workflow.one_run import hold_job_lock
from visuohaptic_workflow.records import check_inputs, check_unchanged, write_record


def set_job_environment(*folders: str | Path) -> None:
    """Let the processes that this one starts look for modules in these folders first, then in the caller's PYTHONPATH.

    They import the package of this checkout, even if another is installed.
    """
    inherited = without_studies_of_clones(os.environ.get("PYTHONPATH", "").split(os.pathsep))
    paths = dict.fromkeys([*map(str, folders), *filter(None, inherited)])
    os.environ["PYTHONPATH"] = os.pathsep.join(paths)


def without_studies_of_clones(paths: Iterable[str]) -> list[str]:
    """Drop folders ``studies`` of clones from a search path: modules of another clone would hide this one's."""
    return [path for path in paths if not _is_studies_of_clone(Path(path))]


def _is_studies_of_clone(path: Path) -> bool:
    return path.name == "studies" and (path.parent / "workflow/Snakefile").is_file()


@contextmanager
def job(snakemake: Any) -> Iterator[None]:
    """Run a job's work: time it, log it for `visuohaptic.io.job_logs.read_seconds`, and end with one sentence where it can't be done.

    After any error it exits with status 1: the sentence goes to standard error and the log, which alone gets a traceback
    where the error was not foreseen. Where the user stopped the run, with status 130 and nothing printed.
    """
    path = Path(snakemake.log[0])
    try:
        hold_job_lock()
        path.parent.mkdir(parents=True, exist_ok=True)
        if "pyarrow" in sys.modules:
            keep_pandas_out()
        allow_pandas()
        started = time.time()
        imports = _seconds_since_start()
        given = snakemake.params.get("key")
        if given:
            check_inputs(given)
        yield
        if given:
            check_unchanged(given)
        write_record(snakemake, given)
    except KeyboardInterrupt:
        raise SystemExit(STOPPED) from None
    except VisuohapticError as error:
        _end_with(path, f"error: {error}", "")
    except Exception as error:  # noqa: BLE001 - the job ends here, and says why
        _end_with(
            path, f"error: {type(error).__name__}: {error} (see {path})", traceback.format_exc()
        )
    work = time.time() - started
    path.write_text(f"done\n{SECONDS} imports {imports:.3f} work {work:.3f}\n", encoding="utf-8")


def _end_with(log: Path, sentence: str, details: str) -> None:
    log.write_text(f"{sentence}\n{details}", encoding="utf-8")
    sys.stderr.write(f"{sentence}\n")
    raise SystemExit(1)


if sys.platform == "linux":

    def _seconds_since_start() -> float:
        """Return the age of this process; the kernel knows it to a hundredth of a second."""
        # Field 22 of 52; the name in field 2 may hold spaces and brackets.
        fields = Path("/proc/self/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return time.clock_gettime(time.CLOCK_BOOTTIME) - int(fields[19]) / os.sysconf("SC_CLK_TCK")

else:
    import psutil

    def _seconds_since_start() -> float:
        """Return the age of this process."""
        return time.time() - psutil.Process().create_time()
