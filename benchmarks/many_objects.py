"""How the workflow grows with objects: seconds of processor time and memory to plan a run of 12, 1,000 and 3,000.

`python -m benchmarks.many_objects FOLDER [COUNT …]` makes the objects, too: the paper's twelve, each deformed by a seed.
They stay in FOLDER, where `snakemake -s Snakefile -d FOLDER` then runs them.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[1]
COUNTS = (12, 142, 1000, 3000)
BLOCKS = {12: 6, 142: 24}
"""Objects a job; 50 where there are more objects."""
LARGEST_BEND = 0.15


def make_objects(folder: Path, count: int) -> None:
    """Write deformed copies of the paper's objects as a user's own meshes.

    Parameters
    ----------
    folder : path
        The folder of the run; gets ``meshes/own/<class>/<object>.ply``. Meshes that are there stay.
    count : int
        How many.
    """
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
    """Stretch along the axes and add a smooth wave.

    Parameters
    ----------
    vertices : ndarray, shape (n, 3)
        In any unit.
    generator : numpy.random.Generator
        Chooses stretch, wave and direction.

    Returns
    -------
    ndarray, shape (n, 3)
        In the same unit.
    """
    size = np.ptp(vertices, axis=0).max()
    stretch = generator.uniform(1 - LARGEST_BEND, 1 + LARGEST_BEND, 3)
    wave = generator.normal(size=3) / size
    direction = generator.normal(size=3) * LARGEST_BEND * size / 6
    return vertices * stretch + np.sin(vertices @ wave)[:, None] * direction


def measure(folder: Path, *options: str) -> dict[str, float]:
    """Plan a run, and give seconds of processor time and the largest memory.

    Parameters
    ----------
    folder : path
        Where.
    *options : str
        Options of Snakemake.

    Returns
    -------
    dict of float
        ``processor_s`` and ``memory_mb``.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "snakemake", "-s", str(ROOT / "Snakefile"), "-d", str(folder), *options],
        env={**os.environ, "PYTHONPATH": f"{ROOT / 'src'}:{ROOT / 'workflow/lib'}"},
        stdout=subprocess.DEVNULL,
    )  # fmt: skip
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"snakemake ended with status {process.returncode}.")
    seconds = used.ru_utime + used.ru_stime
    return {"processor_s": round(seconds, 1), "memory_mb": round(used.ru_maxrss / 1024)}


def run() -> dict[str, object]:
    """Measure all counts in a folder that does not stay."""
    with tempfile.TemporaryDirectory() as folder:
        return plan_all(Path(folder), COUNTS)


def plan_all(folder: Path, counts: tuple[int, ...]) -> dict[str, object]:
    """Measure dry runs with a job a phase and object, and with blocks.

    Parameters
    ----------
    folder : path
        Gets a folder for each count.
    counts : tuple of int
        Numbers of objects.

    Returns
    -------
    dict
        By count.
    """
    found: dict[str, object] = {}
    for count in counts:
        here = folder / str(count)
        (here / "meshes").mkdir(parents=True, exist_ok=True)
        # No catalogued objects beside the made ones.
        head = (ROOT / "meshes/catalogue.csv").read_text(encoding="utf-8").splitlines()[0]
        (here / "meshes/catalogue.csv").write_text(f"{head}\n", encoding="utf-8")
        shutil.copy(ROOT / "params.yaml", here)
        make_objects(here, count)
        per_job = BLOCKS.get(count, 50)
        blocks = json.dumps({"objects_per_job": per_job})
        found[str(count)] = {
            "dry_run": measure(here, "-n", "--quiet"),
            "objects_per_job": per_job,
            "dry_run_in_blocks": measure(here, "-n", "--quiet", "--config", f"workflow={blocks}"),
        }
        print(count, json.dumps(found[str(count)]), flush=True)
    return found


if __name__ == "__main__":
    chosen = tuple(map(int, sys.argv[2:])) or COUNTS
    plan_all(Path(sys.argv[1]), chosen)
