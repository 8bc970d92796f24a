"""The tour's commands and Python run outside of the clone, from installed wheels: `make wheels`.

Any environment will do that has both wheels with the extra `report`, and pytest:
`python -m pytest --confcutdir tests/installed -o pythonpath=tests tests/installed/tour_from_wheels.py`.
"""

import os
import shlex
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest
import trimesh
from docs.shell_commands import block_commands, blocks
from report.synthetic import lay_out

import contourlets
import meshreaders
import visuohaptic

ROOT = Path(__file__).parents[2]
TOUR = ROOT / "docs/tour.md"
SITE = Path(visuohaptic.__file__).parents[1]
# Beside the packages where pip installed with --target, else beside Python.
FOLDERS = (SITE / "bin", Path(sys.executable).parent)
SCRIPT = next(path for folder in FOLDERS if (path := folder / "visuohaptic").is_file())
LEFT_OUT = {"snakemake": "it needs the clone; here the model is that of the package"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder outside of the clone with a mesh, a finished run and a model."""
    folder = tmp_path_factory.mktemp("tour")
    assert ROOT not in folder.parents
    trimesh.creation.annulus(0.8, 1, 2).export(folder / "mug.obj")
    for place in ("before", "."):
        (folder / place).mkdir(exist_ok=True)
        lay_out(folder / place)
    model = folder / "results/models/recogniser.skops"
    model.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(str(files("visuohaptic.exploration") / "recogniser.skops"), model)
    return folder


def run(folder, *words):
    environment = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTEST_", "VISUOHAPTIC_"))
    }
    done = subprocess.run(
        words, cwd=folder, env=environment, check=False, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, f"{shlex.join(words)} failed:\n{done.stdout[-5000:]}"
    return done.stdout


def test_the_packages_are_those_of_the_wheels():
    for package in (visuohaptic, contourlets, meshreaders):
        parents = Path(package.__file__).parents
        assert ROOT / "src" not in parents
        assert ROOT / "packages" not in parents


def test_the_command_prints_the_version_of_the_release(folder):
    assert run(folder, str(SCRIPT), "--version") == f"visuohaptic {visuohaptic.__version__}\n"


def test_the_commands_of_the_tour_run(folder):
    for program, *arguments in block_commands(TOUR):
        if program not in LEFT_OUT:
            assert program == "visuohaptic"
            run(folder, str(SCRIPT), *arguments)
    made = ("mug/poses.csv", "random/features.parquet", "pressed/imprints.npy", "page/report.html")
    assert [name for name in (*made, "runs.csv") if not (folder / name).is_file()] == []


@pytest.mark.parametrize("index", range(len(blocks(TOUR, "python"))))
def test_the_python_of_the_tour_runs(folder, index):
    run(folder, sys.executable, "-c", blocks(TOUR, "python")[index])
