"""Kill a small run of the workflow at random moments, start it again, and look for half-written tables.

`python -m numerics.kills [KILLS]` (with `tests` and `src` on PYTHONPATH) prints what it finds.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from small_experiment import copy_experiment

COPIED = (
    "Snakefile",
    "params.yaml",
    "workflow",
    "src",
    "packages",
    "meshes/paper",
    "meshes/own",
    "profiles",
)
OBJECTS = ("bs0_yogurtBottle", "bsby_chair3")
SMALL = {
    "viewpoints": {"count": 2},
    "rendering": {"resolution": 32},
    "workflow": {"views_per_job": 1},
}
TARGETS = ("results/features", "results/touches", "results/fixations", "results/views")
RUN_SECONDS = 240


def start(folder):
    """Start the run in a process group of its own."""
    environment = {
        key: value
        for key, value in os.environ.items()
        if not key.startswith(("GIT_", "PYTEST_", "DVC_")) and key != "PYTHONPATH"
    }
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    environment["PYTHONHASHSEED"] = "random"
    return subprocess.Popen(
        ["snakemake", "-j2", "--nolock", "--rerun-incomplete", "--quiet", "all", "--", "features_all"],
        cwd=folder, env=environment, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=(folder / "errors.txt").open("w"),
    )  # fmt: skip


def tables(folder):
    """Give every table's file that a reader would take, with its rows; None for one that can't be read."""
    found = {}
    for target in TARGETS:
        for file in sorted((folder / target).rglob("[!._]*.parquet")):
            try:
                table = pq.ParquetFile(file).read()
            except Exception:  # noqa: BLE001 whatever a torn file does to the reader is the finding
                table = None
            found[str(file.relative_to(folder))] = table
    return found


def runs_until(process, folder, count):
    """Tell whether a run still goes on when that many tables are there."""
    while process.poll() is None:
        if sum(1 for target in TARGETS for _ in (folder / target).rglob("[!._]*.parquet")) >= count:
            return True
        time.sleep(0.02)
    return False


def faults(found, expected):
    """Name each table that can't be read or isn't what a whole run makes of it."""
    for name, table in found.items():
        if table is None:
            yield f"{name} is half written"
        elif name not in expected or not table.equals(expected[name]):
            yield f"{name} differs from a whole run's"


def kill_runs(folder, kills, seed):
    """Kill runs; give counts and every table that was not what a whole run makes of it.

    A moment is drawn by how far the run has come, and some tenths of a second more: by the
    clock alone a busy machine would be killed in its start, an idle one after its end.
    """
    folder = Path(folder)
    whole, tried = folder / "whole", folder / "tried"
    for copy in (whole, tried):
        copy_experiment(copy, COPIED, OBJECTS, SMALL)
    started = time.perf_counter()
    process = start(whole)
    if process.wait(timeout=RUN_SECONDS):
        raise RuntimeError((whole / "errors.txt").read_text()[-2000:])
    expected = tables(whole)
    generator = np.random.default_rng(seed)
    count = finished = leftovers = checked = 0
    wrong = []
    while count < kills:
        present = len(tables(tried))
        process = start(tried)
        moment = generator.integers(present, len(expected))
        delay = generator.uniform(0.0, 0.4)
        if runs_until(process, tried, moment):
            time.sleep(delay)
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            count += 1
        else:
            finished += 1
            if process.returncode:
                wrong.append(f"restart failed: {(tried / 'errors.txt').read_text()[-300:]}")
            if set(tables(tried)) != set(expected):
                wrong.append("a finished run lacks tables")
            shutil.rmtree(tried / "results")
            continue
        leftovers += any((tried / "results").rglob(".*parquet-*"))
        found = tables(tried)
        checked += len(found)
        wrong += [f"{fault} (kill {count})" for fault in faults(found, expected)]
        # Every fourth kill meets a run begun anew, the rest one that was killed before.
        if count % 4 == 0 or len(found) == len(expected):
            shutil.rmtree(tried / "results", ignore_errors=True)
    process = start(tried)
    if process.wait(timeout=RUN_SECONDS):
        wrong.append(f"the last restart failed: {(tried / 'errors.txt').read_text()[-300:]}")
    final = tables(tried)
    if set(final) != set(expected) or not all(
        final[name] is not None and final[name].equals(table) for name, table in expected.items()
    ):
        wrong.append("the tables after the last restart differ from a whole run's")
    return {
        "kills": count,
        "runs_finished_between": finished,
        "tables_checked": checked,
        "killed_while_writing": leftovers,
        "wrong": wrong,
        "seconds": round(time.perf_counter() - started, 1),
    }


def kill_writers(folder, kills, seed):
    """Kill a process that writes one table again and again; read it after each kill."""
    from visuohaptic.tables.phases import VIEWS
    from visuohaptic.tables.schema import build_table, read_table, write_table

    def table(mark):
        blob = bytes([mark]) * 50_000
        numbers = np.arange(40)
        columns = {
            "class": "cup", "object": "mug", "viewpoint": numbers, "eye_x": float(mark),
            "eye_y": 0.0, "eye_z": 0.0, "view": [blob] * 40, "saliency": [blob] * 40,
            "conspicuity": [[("edge", blob)]] * 40, "skipped": [[]] * 40, "distinct_fixations": numbers,
        }  # fmt: skip
        return build_table(VIEWS, columns)

    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "table.parquet"
    versions = [table(mark) for mark in (1, 2)]
    write_table(VIEWS, versions[0], path)
    generator = np.random.default_rng(seed)
    started = time.perf_counter()
    leftovers, wrong = 0, []
    for kill in range(kills):
        child = os.fork()
        if child == 0:
            while True:
                for version in versions:
                    write_table(VIEWS, version, path)
        time.sleep(float(generator.uniform(0.002, 0.05)))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        torn = list(folder.glob(".table.parquet-*"))
        leftovers += bool(torn)
        for file in torn:
            file.unlink()
        found = read_table(VIEWS, folder)
        if not any(found.equals(version) for version in versions):
            wrong.append(f"the table after kill {kill} is neither the old nor the new one")
    return {
        "kills": kills,
        "runs_finished_between": 0,
        "tables_checked": kills,
        "killed_while_writing": leftovers,
        "wrong": wrong,
        "seconds": round(time.perf_counter() - started, 1),
    }


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        found = kill_runs(scratch, int(sys.argv[1]) if len(sys.argv) > 1 else 100, 1)
    sys.stdout.write(json.dumps(found, indent=1) + "\n")
    sys.exit(bool(found["wrong"]))
