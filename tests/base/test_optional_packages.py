"""The library and its command work with the core's packages alone; what needs more says so in one sentence."""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import trimesh
from source_folders import PYTHONPATH, link_installed

from visuohaptic.base import optional_packages
from visuohaptic.base.errors import MissingPackageError
from visuohaptic.report.compare_runs import read_metrics

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    """A folder that holds the packages of the core, and no others."""
    folder = tmp_path_factory.mktemp("core")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    link_installed(project["dependencies"], folder, known=["contourlets", "meshreaders"])
    return folder


@pytest.fixture
def run_in_core(core, tmp_path):
    def run(program, *arguments):
        # Neither this environment's packages nor the user's own are seen.
        environment = {
            key: value for key, value in os.environ.items() if not key.startswith("PYTHON")
        }
        return subprocess.run(
            [sys.executable, "-S", "-c", program, *map(str, arguments)],
            cwd=tmp_path, env=environment | {"PYTHONPATH": f"{PYTHONPATH}{os.pathsep}{core}"},
            capture_output=True, text=True, check=False,
        )  # fmt: skip

    return run


COMMAND = "from visuohaptic.cli.main import main; main()"


@pytest.mark.slow
def test_an_object_is_loaded_touched_and_saved(run_in_core, tmp_path):
    trimesh.creation.box().export(tmp_path / "box.ply")
    done = run_in_core(COMMAND, "touch", "box.ply", "--viewpoints", 1, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["touches"] > 0
    assert {file.name for file in (tmp_path / "touched").iterdir()} >= {"touches.parquet"}


@pytest.mark.slow
def test_every_module_but_those_of_report_environment_and_open3d_can_be_imported(run_in_core):
    done = run_in_core("""
import importlib, pkgutil
from importlib.util import find_spec
import visuohaptic
for name in ("dvc", "gymnasium", "jinja2", "matplotlib", "open3d", "pandas", "psutil", "snakemake"):
    assert find_spec(name) is None, name
for module in pkgutil.walk_packages(visuohaptic.__path__, "visuohaptic."):
    needs_extra = module.name.startswith(("visuohaptic.environment.", "visuohaptic.report."))
    if not needs_extra and "open3d" not in module.name:
        importlib.import_module(module.name)
""")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("report", "."), "jinja2 and matplotlib are not installed; `{}` brings them.\n"),
        (("compare", "a.json", "b.json"), "pandas is not installed; `{}` brings it.\n"),
    ],
)
def test_a_command_of_the_report_says_which_extra_to_install(run_in_core, arguments, sentence):
    done = run_in_core(COMMAND, *arguments)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "error: " + sentence.format("pip install 'visuohaptic[report]'")


def test_an_experiment_of_dvc_says_which_extra_to_install(monkeypatch):
    monkeypatch.setattr(optional_packages, "find_spec", lambda name: None)
    with pytest.raises(MissingPackageError, match=r"^dvc is not .*visuohaptic\[workflow\]"):
        read_metrics("experiment")
