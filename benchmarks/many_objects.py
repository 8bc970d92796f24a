"""How the workflow grows with objects: seconds and memory of each step, for 12 to 568 objects, or as many as asked.

`python -m benchmarks.many_objects FOLDER [COUNT …]` makes the objects, the paper's twelve, each deformed by a seed, and
the whole run from nothing, and what follows it. Figures are kept as FOLDER/measured.json. The objects stay in FOLDER,
where `snakemake -s Snakefile -d FOLDER/COUNT` runs them.
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
COUNTS = (12, 24, 48, 142, 568)
BLOCKS = {12: 4, 24: 6, 48: 12, 142: 24}
"""Objects a job; 50 where there are more objects."""
LARGEST_BEND = 0.15
SECONDS_BETWEEN_SAMPLES = 1.0
Steps = dict[str, dict[str, float]]


def make_objects(folder: Path, count: int) -> None:
    """Write so many deformed copies of the paper's objects as a user's own meshes; those that are there stay."""
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
    """Run Snakemake in a folder, and give what it took.

    ``seconds``; ``processor_s`` of Snakemake and of the processes that it started; and ``memory_mb``: the most that all
    processes had together, each shared page counted once.
    """
    started = time.monotonic()
    with (folder / "snakemake.out").open("ab") as out:
        process = subprocess.Popen(
            [sys.executable, "-m", "snakemake", "-s", str(ROOT / "Snakefile"), "-d", str(folder), *options],
            env=_environment(),
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


def _environment() -> dict[str, str]:
    """Give the environment of users: with bytecode, and this clone's modules."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    folders = ("src", "packages/contourlets/src", "workflow/lib")
    return {**kept, "PYTHONPATH": os.pathsep.join(str(ROOT / folder) for folder in folders)}


def _watch_memory(process: int, most: list[float], ended: threading.Event) -> None:
    """Keep the largest sum of the memory of a process and all its descendants, in MB."""
    import psutil

    while not ended.wait(SECONDS_BETWEEN_SAMPLES):
        total = 0
        with suppress(psutil.Error):
            first = psutil.Process(process)
            for one in (first, *first.children(recursive=True)):
                with suppress(psutil.Error):
                    total += one.memory_full_info().pss
        most[0] = max(most[0], total / 2**20)


def prepare(folder: Path, count: int, viewpoints: int) -> Path:
    """Make a folder with so many objects and parameters, and give its path."""
    here = folder / str(count)
    (here / "meshes").mkdir(parents=True, exist_ok=True)
    # No catalogued objects beside the made ones.
    head = (ROOT / "meshes/catalogue.csv").read_text(encoding="utf-8").splitlines()[0]
    (here / "meshes/catalogue.csv").write_text(f"{head}\n", encoding="utf-8")
    text = (ROOT / "params.yaml").read_text(encoding="utf-8")
    text = re.sub(r"(?m)^(viewpoints:(?:\n .*)*?\n  count: )\d+", rf"\g<1>{viewpoints}", text)
    (here / "params.yaml").write_text(text, encoding="utf-8")
    make_objects(here, count)
    return here


def run_all(folder: Path, count: int, cores: int) -> Steps:
    """Measure a whole run in blocks from nothing, then one with nothing to do, and the report by itself.

    Raises `SystemExit` if there are results already.
    """
    if (folder / "results").exists():
        raise SystemExit(
            f"{folder / 'results'} is there; a run from nothing needs a new folder or none in its place."
        )
    blocks = {"objects_per_job": BLOCKS.get(count, 50)}
    options = ["--cores", str(cores), "--config", f"workflow={json.dumps(blocks)}"]
    steps = {
        "whole run": measure(folder, *options),
        "nothing to do": measure(folder, *options),
        "report": measure(folder, *options, "--forcerun", "report", "--", "reports/report.html"),
    }
    steps["whole run"] |= of_phases(folder)
    steps["report"]["file_mb"] = round((folder / "reports/report.html").stat().st_size / 1e6, 1)
    tables = [file.stat().st_size for file in (folder / "results").rglob("*") if file.is_file()]
    steps["whole run"]["results_mb"] = round(sum(tables) / 1e6)
    return steps


def of_phases(folder: Path) -> dict[str, float]:
    """Give the seconds of each phase's jobs together, as their logs have them, imports included."""
    from visuohaptic.io.job_logs import read_seconds

    found: dict[str, float] = {}
    for log in (folder / "logs").rglob("*.log"):
        if seconds := read_seconds(log):
            name = f"{log.relative_to(folder / 'logs').with_suffix('').parts[0]}_s"
            found[name] = round(found.get(name, 0.0) + seconds.imports + seconds.work, 1)
    return found


def main() -> None:
    """Measure what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("counts", type=int, nargs="*", default=COUNTS, metavar="count")
    parser.add_argument("--viewpoints", type=int, default=4, help="of each object")
    parser.add_argument("--cores", type=int, default=len(os.sched_getaffinity(0)))
    asked = parser.parse_args()
    found: dict[str, Steps] = {}
    for count in asked.counts:
        here = prepare(asked.folder, count, asked.viewpoints)
        found[str(count)] = run_all(here, count, asked.cores)
        print(count, json.dumps(found[str(count)]), flush=True)
        kept = json.dumps({"viewpoints": asked.viewpoints, "cores": asked.cores, "counts": found})
        (asked.folder / "measured.json").write_text(f"{kept}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
