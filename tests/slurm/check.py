"""Run the experiment under a real Slurm and compare it with a local run: `make test-slurm`.

A cluster of one node is set up on the loopback, and taken down. The set `paper` runs locally, by profiles/slurm, and as
one cluster job by profiles/slurm/one.sh. In the second run the controller and the node's daemon are killed half way.
"""

import argparse
import contextlib
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from one_node import Cluster, ClusterError, install

ROOT = Path(__file__).parents[2]
SECONDS_OF_OUTAGE = 5
SECONDS_TO_RESUME = 30
HOURS = 3600
OBJECTS_PER_JOB = {"paper": 6, "benchmark": 24}
TABLES = [
    "meshes",
    "views",
    "fixations",
    "policy_fixations",
    "touches",
    "features",
    "stability",
    "scores",
    "predictions",
]


def main():
    """Run everything, and end with status 1 where a table differs."""
    arguments = _parse()
    # Else `timeout` would leave the cluster running.
    signal.signal(signal.SIGTERM, _stop)
    install()
    folder = Path(tempfile.mkdtemp(prefix="visuohaptic-slurm-"))
    print(f"folder {folder}", flush=True)
    # The same blocks everywhere, so that files are the same.
    blocks = f"workflow={json.dumps({'objects_per_job': OBJECTS_PER_JOB[arguments.set]})}"
    config = ["--config", f'meshes={{"set": "{arguments.set}"}}', blocks]
    snakemake = [sys.executable, "-m", "snakemake"]
    by_profile = [*snakemake, "--profile", folder / "profile", *config]
    cores = f"--cpus-per-task={arguments.cores}"
    one_job = ["sbatch", "--wait", cores, "--output=/dev/null", ROOT / "profiles/slurm/one.sh"]
    found = {}
    try:
        _write_profile(folder / "profile", arguments.cores)
        command = [*snakemake, "--cores", str(arguments.cores), *config]
        local, expected = _time("local", folder, command, os.environ)
        with Cluster(folder / "cluster", arguments.cores) as cluster:
            seconds, found["blocks"] = _time("blocks", folder, by_profile, cluster.environment)
            print(f"{seconds / local:.2f} times the local run", flush=True)
            is_over = threading.Event()
            place = (cluster, folder / "broken", is_over)
            threading.Thread(target=_break, args=place, daemon=True).start()
            _, found["broken"] = _time("broken", folder, by_profile, cluster.environment)
            if not is_over.is_set():
                raise SystemExit("the run ended before both daemons were killed")
            command = [*one_job, *config]
            seconds, found["one"] = _time("one", folder, command, cluster.environment)
            print(f"{seconds / local:.2f} times the local run", flush=True)
    except ClusterError as error:
        raise SystemExit(str(error)) from None
    differing = {name for name, digests in found.items() if digests != expected}
    if differing or not expected:
        raise SystemExit(f"tables differ from the local run: {', '.join(sorted(differing))}")
    print(f"all {len(expected)} files are equal bit for bit; nothing is left running")
    if not arguments.keep:
        shutil.rmtree(folder)


def _stop(*_):
    """End with everything taken down, also where the signal comes twice, as to a whole group."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    sys.exit("stopped")


def _parse():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--set", default="paper", choices=OBJECTS_PER_JOB)
    parser.add_argument("--cores", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--keep", action="store_true", help="keep all results")
    return parser.parse_args()


def _write_profile(folder, cores):
    """Copy the profile, with this node's cores."""
    text = (ROOT / "profiles/slurm/config.yaml").read_text(encoding="utf-8")
    folder.mkdir()
    lines = [f"cores: {cores}" if line.startswith("cores:") else line for line in text.splitlines()]
    (folder / "config.yaml").write_text("\n".join(lines), encoding="utf-8")


def _time(name, folder, command, environment):
    """Run the workflow in a folder of its own, and return seconds and digests."""
    here = folder / name
    here.mkdir()
    shutil.copy(ROOT / "params.yaml", here)
    (ROOT / ".cache").mkdir(exist_ok=True)
    (here / ".cache").symlink_to(ROOT / ".cache")  # models are downloaded once
    path = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    started = time.monotonic()
    with (here / "run.log").open("wb") as log:
        status = subprocess.run(
            [*command, "-s", ROOT / "Snakefile"], cwd=here, env={**environment, "PATH": path},
            check=False, stdout=log, stderr=subprocess.STDOUT, timeout=HOURS,
        ).returncode  # fmt: skip
    seconds = time.monotonic() - started
    print(f"{name}: {seconds:.0f} s", flush=True)
    if status:
        raise SystemExit(f"{name} ended with status {status}: {here / 'run.log'}")
    return seconds, _digests(here)


def _break(cluster, folder, is_over):
    """Kill both daemons once a block has begun, and start them again."""
    while not list(folder.glob("results/meshes/*/*/*/*.ply")):
        time.sleep(0.5)
    cluster.kill("slurmctld")
    cluster.kill("slurmd")
    time.sleep(SECONDS_OF_OUTAGE)
    cluster.start("slurmctld")
    cluster.start("slurmd")
    is_over.set()
    print("killed slurmctld and slurmd, and started them again", flush=True)
    # A job that was about to start when the controller was killed makes Slurm drain the node.
    for _ in range(SECONDS_TO_RESUME):
        time.sleep(1)
        with contextlib.suppress(ClusterError, subprocess.SubprocessError):
            if "drain" in cluster.run("sinfo", "--noheader", "--format=%T"):
                cluster.run("scontrol", "update", "NodeName=ALL", "State=RESUME")


def _digests(folder):
    """Return the SHA-256 of all files that hold no seconds."""
    files = [
        *(file for table in TABLES for file in (folder / "results" / table).rglob("*.*")),
        folder / "reports/metrics.json",
    ]
    return {
        str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in files
        if file.is_file()
    }


if __name__ == "__main__":
    main()
