"""Same input and seed, same bits: for any block, order of jobs, number of processes, and after kills."""

import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
from numerics import kills
from numerics.shapes import VIEWPOINTS, run_block, run_chain


@pytest.mark.parametrize("processes", [1, pytest.param(2, marks=pytest.mark.hard)])
@pytest.mark.parametrize("rounds", [1, pytest.param(6, marks=pytest.mark.hard)])
def test_blocks_of_viewpoints_in_any_order_and_process_give_the_same_tables(
    hold, tmp_path, processes, rounds
):
    import pyarrow as pa
    import trimesh

    from visuohaptic.tables.schemas import SCHEMAS

    mesh = trimesh.creation.torus(0.6, 0.25, 24, 12)
    mesh.export(tmp_path / "torus.stl")
    whole = run_chain(tmp_path / "torus.stl", tmp_path, name="whole")
    generator = np.random.default_rng(rounds)
    for _ in range(rounds):
        order = generator.permutation(VIEWPOINTS)
        cuts = np.sort(generator.integers(1, VIEWPOINTS, 2))
        blocks = [sorted(block.tolist()) for block in np.split(order, cuts) if len(block)]
        folder = tmp_path / "parts"
        folder.mkdir(exist_ok=True)
        tasks = [(tmp_path / "torus.stl", folder, block) for block in blocks]
        if processes == 1:
            parts = [run_block(task) for task in tasks]
        else:
            with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
                parts = list(pool.map(run_block, tasks))
        for name, table in whole.items():
            keys = [(key, "ascending") for key in SCHEMAS[name].keys]
            joined = pa.concat_tables([part[name] for part in parts]).sort_by(keys)
            hold(
                "determinism/job order, processes and blocks of viewpoints",
                not joined.equals(table.sort_by(keys)),
                f"{name}, blocks {blocks}, {processes} processes",
            )


@pytest.mark.parametrize("count", [40, pytest.param(300, marks=pytest.mark.hard)])
def test_a_writer_that_is_killed_leaves_the_old_table_or_the_new_one(
    hold, recorder, tmp_path, count
):
    found = kills.kill_writers(tmp_path, count, seed=2)
    recorder.tell("kills", {key: value for key, value in found.items() if key != "wrong"})
    hold(
        "determinism/kill -9 and restart",
        [0] * found["kills"] + [1] * len(found["wrong"]),
        "; ".join(found["wrong"][:3])
        or f"{found['killed_while_writing']} writers of one table killed within a write",
        cases=found["kills"],
    )


@pytest.mark.hard
def test_a_run_that_is_killed_again_and_again_never_leaves_half_a_table(hold, recorder, tmp_path):
    found = kills.kill_runs(tmp_path, kills=100, seed=1)
    recorder.tell("kills", {key: value for key, value in found.items() if key != "wrong"})
    hold(
        "determinism/kill -9 and restart",
        [0] * found["kills"] + [1] * len(found["wrong"]),
        "; ".join(found["wrong"][:3])
        or f"{found['killed_while_writing']} kills left a temporary file behind",
        cases=found["kills"],
    )


@pytest.mark.hard
def test_results_do_not_depend_on_the_hash_seed(hold, tmp_path):
    program = (
        "import sys, hashlib, numpy as np, pathlib, trimesh\n"
        "from numerics.shapes import run_chain\n"
        "folder = pathlib.Path(sys.argv[1]); folder.mkdir()\n"
        "trimesh.creation.cone(0.6, 1.2, sections=24).export(folder / 'cone.ply')\n"
        "tables = run_chain(folder / 'cone.ply', folder)\n"
        "print(hashlib.sha256(b''.join(repr(t.to_pydict()).encode() for t in tables.values())).hexdigest())\n"
    )
    import os

    digests = set()
    for seed in ("1", "2"):
        environment = {
            **os.environ,
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join(sys.path),
        }
        ended = subprocess.run(
            [sys.executable, "-c", program, str(tmp_path / seed)],
            env=environment, check=True, capture_output=True, text=True, timeout=120,
        )  # fmt: skip
        digests.add(ended.stdout.strip())
    hold(
        "determinism/job order, processes and blocks of viewpoints",
        len(digests) - 1,
        "two processes with different hash seeds",
        cases=2,
    )
