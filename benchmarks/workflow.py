"""How long the workflow takes: cold, with nothing to do, and after a change."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import yaml

from visuohaptic.job_logs import read_seconds

ROOT = Path(__file__).parents[1]
CORES = 2
ROUNDS = 3
LEFT_BEHIND = shutil.ignore_patterns(
    ".git", ".venv", ".snakemake", ".cache", ".dvc", "results", "logs", "reports", "__pycache__", "tests", ".*_cache"
)  # fmt: skip


def run() -> dict[str, object]:
    """Time one run after another in a copy of the repository.

    Returns
    -------
    dict
        Seconds of wall time of each run, of cold ones the least of three, and the share of a
        cold run's core seconds that went into neither imports nor the jobs' own work; the
        same again with the paper's pipeline alone.
    """
    with tempfile.TemporaryDirectory() as folder:
        both = _copy(Path(folder) / "both")
        paper = _copy(Path(folder) / "paper")
        _set(paper, "recognition", "pipelines", ["paper"])
        cold = _time_cold(both)
        spent = [seconds for log in both.rglob("logs/**/*.log") if (seconds := read_seconds(log))]
        imports = sum(seconds.imports for seconds in spent)
        work = sum(seconds.work for seconds in spent)
        return {
            "cold_run_s": min(cold),
            "jobs": len(spent),
            "imports_core_s": round(imports, 2),
            "work_core_s": round(work, 2),
            "neither_imports_nor_work": round(1 - (imports + work) / (CORES * cold[-1]), 3),
            "no_op_s": _time_run(both),
            **_time_changes(both),
            "paper_pipeline": {
                "cold_run_s": min(_time_cold(paper)),
                **_time_changes(paper),
            },
        }


def _copy(folder: Path) -> Path:
    shutil.copytree(ROOT, folder, ignore=LEFT_BEHIND)
    return folder


def _time_cold(folder: Path) -> list[float]:
    """Run from nothing some times."""
    seconds = []
    for _ in range(ROUNDS):
        for made in ("results", "logs", ".snakemake"):
            shutil.rmtree(folder / made, ignore_errors=True)
        seconds.append(_time_run(folder))
    return seconds


def _time_changes(folder: Path) -> dict[str, float]:
    _set(folder, "recognition", "touch_scaling", "none")
    recognition = _time_run(folder)
    _set(folder, "sensor", "largest_size", 0.29)
    return {"recognition_change_s": recognition, "sensor_change_s": _time_run(folder)}


def _set(folder: Path, section: str, name: str, value: object) -> None:
    path = folder / "params.yaml"
    parameters = yaml.safe_load(path.read_text(encoding="utf-8"))
    parameters[section][name] = value
    path.write_text(yaml.safe_dump(parameters), encoding="utf-8")


def _time_run(folder: Path) -> float:
    started = time.perf_counter()
    subprocess.run(
        ["snakemake", f"-j{CORES}", "--quiet", "all"],
        cwd=folder,
        check=True,
        capture_output=True,
        env={**os.environ, "PYTHONPATH": str(folder / "src")},
    )
    return round(time.perf_counter() - started, 2)


if __name__ == "__main__":
    for name, value in run().items():
        print(f"{name:32} {value}")
