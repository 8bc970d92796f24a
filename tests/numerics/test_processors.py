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
# The emulator's gathers of AVX2 are wrong (QEMU 7.2), and NumPy sorts with them: there it takes its older kernels,
# and its kernels for AVX2 are tested on the processor itself. OpenBLAS takes emulated processors for its host's family
# where that is newer than it knows, and then runs instructions that they don't have: its kernels are named.
PROCESSORS = {
    "NumPy for AVX2": ([], {"NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL"}),
    "OpenBLAS for Haswell": ([], {"OPENBLAS_CORETYPE": "Haswell"}),
    "OpenBLAS for Prescott": ([], {"OPENBLAS_CORETYPE": "Prescott"}),
    "Haswell": (
        [EMULATOR, "-cpu", "Haswell"],
        {"NPY_DISABLE_CPU_FEATURES": "X86_V3", "OPENBLAS_CORETYPE": "Haswell"},
    ),
    "SandyBridge": ([EMULATOR, "-cpu", "SandyBridge"], {"OPENBLAS_CORETYPE": "Sandybridge"}),
}


def run_experiment(folder, meshes, command=(), **environment):
    """Write the arrays of a small experiment, as this or another processor makes them."""
    subprocess.run(
        [*command, sys.executable, str(Path(__file__).with_name("experiment_in_arrays.py")),
         str(folder), *meshes],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **environment},
        cwd=ROOT, check=True, capture_output=True, text=True,
    )  # fmt: skip


def compare(ours, others):
    """Want the arrays of two folders to be the same; name the first by phase, object and column, and its rows."""
    for phase in PHASES:
        names = sorted(path.relative_to(ours) for path in (ours / phase).glob("*/*.npy"))
        assert names
        for name in names:
            one, other = np.load(ours / name), np.load(others / name)
            if one.dtype.kind == "f" and phase in ROUNDED:
                np.testing.assert_allclose(other, one, 0, ROUNDED[phase], err_msg=str(name))
            else:
                np.testing.assert_array_equal(other, one, err_msg=str(name))


@pytest.fixture(scope="module")
def ours(tmp_path_factory):
    folder = tmp_path_factory.mktemp("processors") / "ours"
    run_experiment(folder, MESHES)
    return folder


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("processor", PROCESSORS)
def test_another_processor_gives_the_same_experiment(processor, ours, tmp_path):
    command, environment = PROCESSORS[processor]
    if command and not shutil.which(EMULATOR):
        pytest.skip(f"{EMULATOR} is not there: install Debian's qemu-user to try other processors")
    run_experiment(tmp_path / "others", MESHES, command, **environment)
    compare(ours, tmp_path / "others")


def test_a_column_of_rounding_alone_becomes_zero():
    columns = np.random.default_rng(0).normal(size=(50, 3))
    columns[:, 1] *= 1e-16  # around zero, as a normal's components on a box
    columns[:, 2] = 0.3 + 1e-16 * columns[:, 2]
    scale = fit_standardiser(columns, "standardise", made_of=1.0).scale
    assert scale[0] == pytest.approx(1, abs=0.3)
    assert scale[1:].tolist() == [np.inf, np.inf]
