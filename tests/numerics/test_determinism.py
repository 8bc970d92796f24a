"""Same input and seed, same bits, for any blocks of viewpoints; and a killed writer leaves whole tables."""

import os
import signal
import time

import numpy as np
import pyarrow as pa
import pytest
import trimesh
from numerics.shapes import VIEWPOINTS, run_chain

from visuohaptic.tables.schema import TEXT, Column, Schema, build_table, read_table, write_table
from visuohaptic.tables.schemas import SCHEMAS

VERSIONS = Schema(
    "versions",
    (Column("row", TEXT, "its name"),),
    (Column("version", TEXT, "of the whole table"),),
)


@pytest.mark.parametrize("rounds", [1, pytest.param(6, marks=pytest.mark.hard)])
def test_blocks_of_viewpoints_in_any_order_give_the_same_tables(recorder, tmp_path, rounds):
    source = tmp_path / "torus.stl"
    trimesh.creation.torus(0.6, 0.25, 24, 12).export(source)
    whole = run_chain(source, tmp_path)
    generator = np.random.default_rng(rounds)
    for _ in range(rounds):
        order = generator.permutation(VIEWPOINTS)
        cuts = np.sort(generator.integers(1, VIEWPOINTS, 2))
        blocks = [sorted(block.tolist()) for block in np.split(order, cuts) if len(block)]
        parts = [run_chain(source, tmp_path, block) for block in blocks]
        for name, table in whole.items():
            keys = [(key, "ascending") for key in SCHEMAS[name].keys]
            joined = pa.concat_tables([part[name] for part in parts]).sort_by(keys)
            other = not joined.equals(table.sort_by(keys))
            requirement = "determinism/job order, processes and blocks of viewpoints"
            recorder.hold(requirement, other, f"{name}, blocks {blocks}")


def version(seed):
    """Return a table of a megabyte whose every value tells which version it is of."""
    chance = np.random.default_rng(seed)
    found = sorted(chance.bytes(25_000).hex() for _ in range(40))
    return build_table(VERSIONS, {"row": found, "version": str(seed)})


def kill_while_writing(versions, path, seconds):
    """Kill a process that writes one version after the other."""
    child = os.fork()
    while child == 0:
        for table in versions:
            write_table(VERSIONS, table, path)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)


@pytest.mark.parametrize("kills", [20, pytest.param(300, marks=pytest.mark.hard)])
def test_a_writer_that_is_killed_leaves_the_old_table_or_the_new_one(recorder, tmp_path, kills):
    path = tmp_path / "table.parquet"
    versions = [version(seed) for seed in (1, 2)]
    write_table(VERSIONS, versions[0], path)
    generator = np.random.default_rng(2)
    for kill in range(kills):
        kill_while_writing(versions, path, float(generator.uniform(0.002, 0.05)))
        for torn in tmp_path.glob(".table.parquet-*"):
            torn.unlink()
        found = read_table(VERSIONS, tmp_path)
        whole = any(found.equals(version) for version in versions)
        recorder.hold("determinism/kill -9 and restart", not whole, f"after kill {kill}")
