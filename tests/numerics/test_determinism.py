"""Same input and seed, same bits: for any batch, block, order of jobs, number of processes, and after kills."""

import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numerics import kills
from numerics.shapes import VIEWPOINTS, run_block, run_chain

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.contourlet import Contourlet, directional_deviations
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.recognition.sequence_features import summarise_signals
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.gallery import hard_probes
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.touching import touch

SEEDS = st.integers(0, 2**32 - 1)
KERNELS = {
    "contourlet deviations": directional_deviations,
    "contourlet coefficients": lambda images: Contourlet(levels=(4,)).forward(images).ravel(),
    "shape of imprints": describe_imprint_shape,
    "moments": lambda images: summarise_signals(images.reshape(len(images), -1), 1),
}


@given(
    seed=SEEDS,
    count=st.integers(2, 70),
    kernel=st.sampled_from(sorted(KERNELS)),
    dtype=st.sampled_from([np.float32, np.float64]),
)
def test_a_row_does_not_depend_on_its_batch(hold, seed, count, kernel, dtype):
    generator = np.random.default_rng(seed)
    images = generator.random((count, 32, 32)).astype(dtype)
    together = KERNELS[kernel](images)
    cuts = np.sort(generator.integers(0, count, 3))
    apart = np.concatenate([KERNELS[kernel](part) for part in np.split(images, cuts) if len(part)])
    order = generator.permutation(count)
    shuffled = KERNELS[kernel](images[order])[np.argsort(order)]
    hold(
        "determinism/batch split of kernels",
        [not np.array_equal(together, apart), not np.array_equal(together, shuffled)],
        f"{kernel}, {count} images (seed {seed})",
    )


@given(seed=SEEDS)
@settings(max_examples=settings().max_examples // 2)
def test_a_touch_does_not_depend_on_its_batch(hold, seed):
    generator = np.random.default_rng(seed)
    probe = hard_probes()[generator.integers(len(hard_probes()))]
    caster = RayCaster(probe.surface)
    points = np.array(probe.point) + 0.01 * generator.normal(size=(12, 3))
    normals = np.array(probe.normal) + 0.1 * generator.normal(size=(12, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    together = touch(caster, points, normals, SensorParameters(), Scene())
    order = generator.permutation(12)
    parts = [
        touch(caster, points[k : k + 1], normals[k : k + 1], SensorParameters(), Scene())
        for k in order[:4]
    ]
    wrong = [
        not (
            np.array_equal(part.images[0], together.images[k])
            and part.size[0] == together.size[k]
            and part.contact_state[0] == together.contact_state[k]
        )
        for part, k in zip(parts, order, strict=False)
    ]
    hold("determinism/batch split of kernels", wrong, f"touches on {probe.name} (seed {seed})")


@given(seed=SEEDS, count=st.integers(2, 5))
@settings(max_examples=settings().max_examples // 5)
def test_a_view_does_not_depend_on_its_batch(hold, seed, count):
    generator = np.random.default_rng(seed)
    shape = (count, 32, 32)
    views = {
        "colour": generator.random((*shape, 3)).astype(np.float32),
        "mask": generator.random(shape) < 0.8,
        "point": generator.uniform(-1, 1, (*shape, 3)),
        "normal": np.broadcast_to([0.0, 0.0, 1.0], (*shape, 3)),
        "face": np.zeros(shape, dtype=np.int64),
        "curvature": generator.random(shape).astype(np.float32),
    }
    together = attend(**views, parameters=AttentionParameters())
    wrong = []
    for k in range(count):
        alone = attend(
            **{name: v[k : k + 1] for name, v in views.items()}, parameters=AttentionParameters()
        )[0]
        wrong.append(
            not np.array_equal(alone.saliency, together[k].saliency)
            or not np.array_equal(alone.scanpath.rows, together[k].scanpath.rows)
        )
    hold("determinism/batch split of kernels", wrong, f"attention to {count} views (seed {seed})")


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
        order = generator.permutation(VIEWPOINTS.total)
        cuts = np.sort(generator.integers(1, VIEWPOINTS.total, 2))
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
