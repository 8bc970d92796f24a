"""A small experiment is the same on other processors, from the surface to the predicted classes."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from visuohaptic.recognition.encoding import fit_standardiser

ROOT = Path(__file__).parents[2]
MESHES = [
    "meshes/paper/quadruped/sc_dog.ply.gz",
    "meshes/paper/car/sc_smart-car.ply.gz",  # some of its faces lie on each other, some are narrow
]
PHASES = ("surface", "rays", "views", "saliency", "fixations", "touches", "features", "recognition")
ROUNDED = {"features": 1e-12, "recognition": 1e-12}
"""Phases whose sums a BLAS may take in another order, and by how much their numbers may differ."""

EMULATOR = "qemu-x86_64"
# The emulator's gathers of AVX2 are wrong (QEMU 7.2). NumPy sorts with them and Arrow finds repeated keys: there both
# take their older kernels, and NumPy's kernels for AVX2 are tested on the processor itself. OpenBLAS takes emulated processors for its host's family
# where that is newer than it knows, and then runs instructions that they don't have: its kernels are named.
PROCESSORS = {
    "NumPy for AVX2, OpenBLAS for Prescott": (
        [],
        {"NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL", "OPENBLAS_CORETYPE": "Prescott"},
    ),
    "Haswell": (
        [EMULATOR, "-cpu", "Haswell"],
        {
            "NPY_DISABLE_CPU_FEATURES": "X86_V3",
            "OPENBLAS_CORETYPE": "Haswell",
            "ARROW_USER_SIMD_LEVEL": "SSE4_2",
        },
    ),
    "SandyBridge": ([EMULATOR, "-cpu", "SandyBridge"], {"OPENBLAS_CORETYPE": "Sandybridge"}),
}


def run_experiment(file, command=(), **environment):
    """Return the arrays of a small experiment, as this or another processor makes them."""
    experiment = str(Path(__file__).with_name("experiment_in_arrays.py"))
    subprocess.run(
        [*command, sys.executable, experiment, str(file), *MESHES],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **environment},
        cwd=ROOT, check=True, capture_output=True, text=True,
    )  # fmt: skip
    return np.load(file)


@pytest.fixture(scope="module")
def ours(tmp_path_factory):
    return run_experiment(tmp_path_factory.mktemp("processors") / "ours.npz")


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("processor", PROCESSORS)
def test_another_processor_gives_the_same_experiment(processor, ours, tmp_path):
    command, environment = PROCESSORS[processor]
    if command and not shutil.which(EMULATOR):
        pytest.skip(f"{EMULATOR} is not there: install Debian's qemu-user to try other processors")
    others = run_experiment(tmp_path / "others.npz", command, **environment)
    assert set(ours.files) == set(others.files)
    phases = {name: name.partition("/")[0] for name in ours.files}
    assert set(phases.values()) == set(PHASES)
    # The first phase in which something differs is the one to look at.
    for name in sorted(ours.files, key=lambda name: PHASES.index(phases[name])):
        one, other = ours[name], others[name]
        if one.dtype.kind == "f" and phases[name] in ROUNDED:
            np.testing.assert_allclose(other, one, 0, ROUNDED[phases[name]], err_msg=name)
        else:
            np.testing.assert_array_equal(other, one, err_msg=name)


def test_a_column_of_rounding_alone_becomes_zero():
    columns = np.random.default_rng(0).normal(size=(50, 3))
    columns[:, 1] *= 1e-16  # around zero, as a normal's components on a box
    columns[:, 2] = 0.3 + 1e-16 * columns[:, 2]
    scale = fit_standardiser(columns, "standardise", input_size=1.0).scale
    assert scale[0] == pytest.approx(1, abs=0.3)
    assert scale[1:].tolist() == [np.inf, np.inf]
