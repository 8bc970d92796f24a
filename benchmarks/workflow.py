"""How long the workflow takes: cold, with nothing to do, and after a change."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import yaml

from visuohaptic.jobs import read_seconds

ROOT = Path(__file__).parents[1]
CORES = 2
LEFT_BEHIND = shutil.ignore_patterns(
    ".git", ".venv", ".snakemake", ".cache", ".dvc", "results", "logs", "reports", "__pycache__", "tests", ".*_cache"
)  # fmt: skip


def run() -> dict[str, object]:
    """Time one run after another in a copy of the repository.

    Returns
    -------
    dict
        Seconds of wall time of each run, and the share of the cold run's core
        seconds that went into neither imports nor the jobs' own work.
    """
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "experiment"
        shutil.copytree(ROOT, copy, ignore=LEFT_BEHIND)
        cold = _time_run(copy)
        spent = [seconds for log in copy.rglob("logs/**/*.log") if (seconds := read_seconds(log))]
        imports = sum(seconds.imports for seconds in spent)
        work = sum(seconds.work for seconds in spent)
        return {
            "cold_run_s": cold,
            "jobs": len(spent),
            "imports_core_s": round(imports, 2),
            "work_core_s": round(work, 2),
            "neither_imports_nor_work": round(1 - (imports + work) / (CORES * cold), 3),
            "no_op_s": _time_run(copy),
            "recognition_change_s": _time_change(copy, "recognition", "touch_scaling", "none"),
            "sensor_change_s": _time_change(copy, "sensor", "largest_size", 0.29),
        }


def _time_change(folder: Path, section: str, name: str, value: object) -> float:
    path = folder / "params.yaml"
    parameters = yaml.safe_load(path.read_text(encoding="utf-8"))
    parameters[section][name] = value
    path.write_text(yaml.safe_dump(parameters), encoding="utf-8")
    return _time_run(folder)


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
