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


def first_difference(ours, others):
    """Say in which phase, object and touch the arrays of two folders differ first; None where they don't."""
    for phase in PHASES:
        names = sorted(path.relative_to(ours) for path in (ours / phase).glob("*/*.npy"))
        assert names or phase not in {path.name for path in ours.iterdir()}
        for name in names:
            one, other = np.load(ours / name), np.load(others / name)
            if one.shape != other.shape:
                return f"{name.with_suffix('')}: shapes {one.shape} and {other.shape}"
            differ = unlike(one, other, ROUNDED.get(phase, 0.0))
            if differ.any():
                return f"{name.with_suffix('')}: {place_of(ours / name, differ)}"
    return None


def unlike(one, other, tolerance):
    """Tell which entries differ by more than a tolerance; two that are not numbers are alike."""
    if one.dtype.kind not in "fc":
        return one != other
    with np.errstate(invalid="ignore"):
        near = np.abs(one - other) <= tolerance
    return ~(near | (one == other) | (np.isnan(one) & np.isnan(other)))


def place_of(path, differ):
    """Name the row that differs first by the keys that lie beside the array."""
    row = int(np.argwhere(differ)[0][0])
    keys = (path.with_name(f"{key}.npy") for key in ("viewpoint", "strategy", "touch"))
    keyed = [f"{key.stem} {np.load(key)[row]}" for key in keys if key.exists()]
    return f"{', '.join(keyed) or f'row {row}'}, {differ.sum()} of {differ.size} numbers"


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
    assert first_difference(ours, tmp_path / "others") is None


def test_the_first_phase_object_and_touch_that_differ_are_named(tmp_path):
    for folder in ("ours", "others"):
        for phase in ("fixations", "touches"):
            (tmp_path / folder / phase / "dog").mkdir(parents=True)
            np.save(tmp_path / folder / phase / "dog" / "touch.npy", np.arange(3))
            np.save(tmp_path / folder / phase / "dog" / "strategy.npy", np.array(["random"] * 3))
            np.save(tmp_path / folder / phase / "dog" / "x.npy", np.zeros(3))
    assert first_difference(tmp_path / "ours", tmp_path / "others") is None
    np.save(tmp_path / "others" / "touches" / "dog" / "x.npy", np.array([0, 1e-16, 1e-16]))
    assert first_difference(tmp_path / "ours", tmp_path / "others") == (
        "touches/dog/x: strategy random, touch 1, 2 of 3 numbers"
    )


def test_a_column_of_rounding_alone_becomes_zero():
    columns = np.random.default_rng(0).normal(size=(50, 3))
    columns[:, 1] *= 1e-16  # around zero, as a normal's components on a box
    columns[:, 2] = 0.3 + 1e-16 * columns[:, 2]
    scale = fit_standardiser(columns, "standardise", made_of=1.0).scale
    assert scale[0] == pytest.approx(1, abs=0.3)
    assert scale[1:].tolist() == [np.inf, np.inf]
