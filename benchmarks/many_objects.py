"""Measure processor seconds and memory of the workflow for 12 to 1,420 objects, or given numbers of objects.

`python -m benchmarks.many_objects FOLDER [COUNT …]` makes random deformations of the paper's twelve objects, and
measures a whole run by phase, and a run without work. Figures are written to FOLDER/measured.json. The objects stay in
FOLDER, for `snakemake -s Snakefile -d FOLDER/COUNT`.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[1]
COUNTS = (12, 24, 48, 142, 568, 1420)
BLOCKS = {12: 4, 24: 6, 48: 12, 142: 24}
"""Objects per job by number of objects; 50 for other numbers."""
LARGEST_BEND = 0.15
SECONDS_BETWEEN_SAMPLES = 1.0
JOBS = "measured_jobs.jsonl"
"""File of a run's folder with one line per job, as `measured_jobs/sitecustomize.py` writes it."""

Steps = dict[str, dict[str, float]]


def make_objects(folder: Path, count: int) -> None:
    """Write `count` deformed copies of the paper's objects as own meshes; existing files are kept."""
    from visuohaptic.geometry.surface import read_surface, write_surface

    sources = sorted((ROOT / "meshes/paper").rglob("*.ply.gz"))
    models = [read_surface(source) for source in sources]
    for number in range(count):
        source, model = sources[number % len(sources)], models[number % len(sources)]
        path = folder / "meshes/own" / source.parent.name / f"{number:05d}.ply"
        if path.exists():
            continue
        bent = bend(model.vertices, np.random.default_rng(number))
        write_surface(replace(model, vertices=bent), path)


def bend(vertices: np.ndarray, generator: np.random.Generator) -> np.ndarray:
    """Stretch vertices (n, 3) along the axes and add a smooth wave."""
    size = np.ptp(vertices, axis=0).max()
    stretch = generator.uniform(1 - LARGEST_BEND, 1 + LARGEST_BEND, 3)
    wave = generator.normal(size=3) / size
    direction = generator.normal(size=3) * LARGEST_BEND * size / 6
    return vertices * stretch + np.sin(vertices @ wave)[:, None] * direction


def measure(folder: Path, *options: str) -> dict[str, float]:
    """Run Snakemake in a folder, and measure time and memory.

    Returns wall time ``seconds``, ``processor_s`` of Snakemake and its child processes, and ``memory_mb``, the peak of
    the memory of all processes (PSS: shared pages count once).
    """
    started = time.monotonic()
    with (folder / "snakemake.out").open("ab") as out:
        process = subprocess.Popen(
            [sys.executable, "-m", "snakemake", "-s", str(ROOT / "Snakefile"), "-d", str(folder), *options],
            env=_environment(folder / JOBS),
            stdout=out, stderr=out,
        )  # fmt: skip
        most = [0.0]
        ended = threading.Event()
        watch = threading.Thread(target=_watch_memory, args=(process.pid, most, ended), daemon=True)
        watch.start()
        _, status, used = os.wait4(process.pid, 0)
        ended.set()
        watch.join()
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(
            f"snakemake ended with status {process.returncode}: {folder / 'snakemake.out'}"
        )
    return {
        "seconds": round(time.monotonic() - started, 1),
        "processor_s": round(used.ru_utime + used.ru_stime, 1),
        "memory_mb": round(max(most[0], used.ru_maxrss / 1024)),
    }


def _environment(jobs: Path) -> dict[str, str]:
    """Return an environment with bytecode, as users have, and with this clone's modules; jobs append a line to `jobs`."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    folders = (
        "src",
        "packages/contourlets/src",
        "packages/meshreaders/src",
        "workflow/lib",
        "benchmarks/measured_jobs",
    )
    paths = os.pathsep.join(str(ROOT / folder) for folder in folders)
    return {**kept, "PYTHONPATH": paths, "MEASURED_JOBS": str(jobs.resolve())}


def _watch_memory(process: int, most: list[float], ended: threading.Event) -> None:
    """Update `most` to the largest sum of the memory of a process and all descendants, MB."""
    import psutil

    while not ended.wait(SECONDS_BETWEEN_SAMPLES):
        total = 0
        with suppress(psutil.Error):
            first = psutil.Process(process)
            for child in (first, *first.children(recursive=True)):
                with suppress(psutil.Error):
                    total += child.memory_full_info().pss
        most[0] = max(most[0], total / 2**20)


def prepare(folder: Path, count: int, viewpoints: int) -> Path:
    """Make a folder with `count` objects and parameters; return its path."""
    here = folder / str(count)
    (here / "meshes").mkdir(parents=True, exist_ok=True)
    # An empty catalogue: only the deformed objects are used.
    head = (ROOT / "meshes/catalogue.csv").read_text(encoding="utf-8").splitlines()[0]
    (here / "meshes/catalogue.csv").write_text(f"{head}\n", encoding="utf-8")
    text = (ROOT / "params.yaml").read_text(encoding="utf-8")
    text = re.sub(r"(?m)^(viewpoints:(?:\n .*)*?\n  count: )\d+", rf"\g<1>{viewpoints}", text)
    (here / "params.yaml").write_text(text, encoding="utf-8")
    make_objects(here, count)
    return here


def run_all(folder: Path, count: int, cores: int) -> Steps:
    """Measure a whole run, the phases of this run, and a second run without work.

    Raises `SystemExit` if the folder has results.
    """
    if (folder / "results").exists():
        raise SystemExit(
            f"{folder / 'results'} exists; a whole run needs a folder without results."
        )
    blocks = {"objects_per_job": BLOCKS.get(count, 50)}
    options = ["--cores", str(cores), "--config", f"workflow={json.dumps(blocks)}"]
    whole = measure(folder, *options)
    phases = of_phases(folder / JOBS)
    tables = [file.stat().st_size for file in (folder / "results").rglob("*") if file.is_file()]
    whole["results_mb"] = round(sum(tables) / 1e6)
    return {"whole run": whole, "nothing to do": measure(folder, *options), **phases}


def of_phases(jobs: Path) -> Steps:
    """Return ``processor_s``, summed over the jobs of a phase, and ``memory_mb`` of the largest job, by phase."""
    phases: Steps = {}
    for line in jobs.read_text(encoding="utf-8").splitlines():
        job = json.loads(line)
        phase = phases.setdefault(job["phase"], {"processor_s": 0.0, "memory_mb": 0})
        phase["processor_s"] = round(phase["processor_s"] + job["processor_s"], 1)
        phase["memory_mb"] = max(phase["memory_mb"], round(job["memory_mb"]))
    return phases


def main() -> None:
    """Measure the numbers of objects on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("counts", type=int, nargs="*", default=COUNTS, metavar="count")
    parser.add_argument("--viewpoints", type=int, default=4, help="of each object")
    parser.add_argument("--cores", type=int, default=len(os.sched_getaffinity(0)))
    arguments = parser.parse_args()
    settings = {"viewpoints": arguments.viewpoints, "cores": arguments.cores}
    steps: dict[str, Steps] = {}
    for count in arguments.counts:
        here = prepare(arguments.folder, count, arguments.viewpoints)
        steps[str(count)] = run_all(here, count, arguments.cores)
        print(count, json.dumps(steps[str(count)]), flush=True)
        text = json.dumps({**settings, "counts": steps})
        (arguments.folder / "measured.json").write_text(f"{text}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
