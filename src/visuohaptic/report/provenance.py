"""Versions, machine, and the seconds of each phase."""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import visuohaptic
from visuohaptic import phases
from visuohaptic.io.job_logs import JobSeconds, read_seconds

PHASES = ("downloads", *(phase.name for phase in phases.PHASES), "metrics")
_DISTRIBUTIONS = (
    *(
        "contourlets",
        "meshreaders",
        "numpy",
        "scipy",
        "opencv-contrib-python-headless",
        "open3d-cpu",
        "open3d",
    ),
    *("trimesh", "PyWavelets", "minisom", "scikit-learn", "pyarrow", "pydantic"),
    *("snakemake", "dvc", "Jinja2", "matplotlib"),
)


@dataclass(frozen=True)
class PhaseSeconds:
    """Run time of a phase.

    Attributes
    ----------
    phase : str
        The name of the phase.
    jobs : int
        Finished jobs.
    imports, work : float
        Seconds of start and imports, and of work: sums over the last run of each finished job.
    unfinished : tuple of str
        Logs of jobs that did not finish.
    """

    phase: str
    jobs: int
    imports: float
    work: float
    unfinished: tuple[str, ...]


def find_versions() -> list[tuple[str, str]]:
    """Return name and version of this package, Python and the installed libraries that affect results."""
    versions = [("visuohaptic", visuohaptic.__version__), ("Python", platform.python_version())]
    for name in _DISTRIBUTIONS:
        try:
            versions.append((name, version(name)))
        except PackageNotFoundError:
            continue
    return versions


def describe_machine() -> list[tuple[str, str]]:
    """Return system, processor, cores and memory of the machine, without its host name."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return [
        ("System", f"{platform.system()} {platform.release()}"),
        ("Processor", _processor()),
        ("Cores", str(cores)),
        ("Memory", _memory()),
    ]


def phase_seconds(folder: str | Path) -> list[PhaseSeconds]:
    """Return the run time of each phase from the logs in a folder, in the order of the phases.

    A phase's logs are ``<phase>.log`` or files in the folder ``<phase>``.
    """
    logs: dict[str, dict[str, JobSeconds | None]] = {}
    for log in sorted(Path(folder).rglob("*.log")):
        phase = log.relative_to(folder).parts[0].removesuffix(".log")
        logs.setdefault(phase, {})[str(log)] = read_seconds(log)
    logs.pop("report", None)
    summed = []
    for phase, seconds_of_log in logs.items():
        done = [seconds for seconds in seconds_of_log.values() if seconds is not None]
        unfinished = tuple(log for log, seconds in seconds_of_log.items() if seconds is None)
        imports, work = sum(job.imports for job in done), sum(job.work for job in done)
        summed.append(PhaseSeconds(phase, len(done), imports, work, unfinished))
    order = {phase: index for index, phase in enumerate(PHASES)}
    return sorted(summed, key=lambda row: (order.get(row.phase, len(PHASES)), row.phase))


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _memory() -> str:
    try:
        total = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return "unknown"
    return f"{total / 2**30:.1f} GiB"
