"""Time the workflow: a run from nothing, a run without work, and runs after a change."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import yaml

from visuohaptic.io.job_logs import read_seconds

ROOT = Path(__file__).parents[1]
CORES = 2
ROUNDS = 3
LEFT_BEHIND = shutil.ignore_patterns(
    ".git", ".venv", ".snakemake", ".cache", ".dvc", "results", "logs", "reports", "__pycache__", "tests", ".*_cache"
)  # fmt: skip


def run() -> dict[str, object]:
    """Time runs in copies of the repository.

    Returns wall seconds of each run, and processor seconds of all processes with ``_cpu``. Runs from nothing are the
    quickest of three. ``paper_pipeline`` has the same runs with only pipeline `paper`. Also returns the load before, and
    whether Python writes bytecode.
    """
    with tempfile.TemporaryDirectory() as folder:
        both = _copy(Path(folder) / "both")
        paper = _copy(Path(folder) / "paper")
        _set(paper, "recognition", "pipelines", ["paper"])
        load = os.getloadavg()[0]
        cold = _time_cold(both)
        spent = [seconds for log in both.rglob("logs/**/*.log") if (seconds := read_seconds(log))]
        return {
            "load_before": round(load, 2),
            "bytecode": True,
            **named("cold_run", cold),
            "jobs": len(spent),
            "imports_core_s": round(sum(seconds.imports for seconds in spent), 2),
            "work_core_s": round(sum(seconds.work for seconds in spent), 2),
            **named("no_op", _time_run(both)),
            **_time_changes(both),
            "paper_pipeline": {**named("cold_run", _time_cold(paper)), **_time_changes(paper)},
        }


def named(name: str, seconds: tuple[float, float]) -> dict[str, float]:
    """Return wall and processor seconds as two entries."""
    return {f"{name}_s": seconds[0], f"{name}_cpu_s": seconds[1]}


def _copy(folder: Path) -> Path:
    shutil.copytree(ROOT, folder, ignore=LEFT_BEHIND)
    return folder


def _time_cold(folder: Path) -> tuple[float, float]:
    """Run from nothing `ROUNDS` times; return the seconds of the quickest run."""
    seconds = []
    for _ in range(ROUNDS):
        for name in ("results", "logs", ".snakemake", ".cache"):
            shutil.rmtree(folder / name, ignore_errors=True)
        seconds.append(_time_run(folder))
    return min(seconds)


def _time_changes(folder: Path) -> dict[str, float]:
    _set(folder, "recognition", "sequence_scaling", "none")
    recognition = named("recognition_change", _time_run(folder))
    _set(folder, "sensor", "largest_size", 0.29)
    return {**recognition, **named("sensor_change", _time_run(folder))}


def _set(folder: Path, section: str, name: str, value: object) -> None:
    path = folder / "params.yaml"
    parameters = yaml.safe_load(path.read_text(encoding="utf-8"))
    parameters[section][name] = value
    path.write_text(yaml.safe_dump(parameters), encoding="utf-8")


def _time_run(folder: Path) -> tuple[float, float]:
    """Run the workflow; return wall seconds, and processor seconds of all processes."""
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in {"PYTHONDONTWRITEBYTECODE", "PYTHONPATH"}
    }
    started, spent = time.perf_counter(), _processor_seconds()
    subprocess.run(
        ["snakemake", f"-j{CORES}"], cwd=folder, check=True, capture_output=True, env=environment
    )
    return round(time.perf_counter() - started, 2), round(_processor_seconds() - spent, 2)


def _processor_seconds() -> float:
    """Return the processor seconds of all child processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    for name, value in run().items():
        print(f"{name:32} {value}")
