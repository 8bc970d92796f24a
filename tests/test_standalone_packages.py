"""`contourlets`, `meshreaders` and `attention` can each be published alone: they use nothing of the rest."""

import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from source_folders import link_installed

ROOT = Path(__file__).parents[1]
FOLDERS = {
    "visuohaptic_attention": ROOT / "src/visuohaptic/attention",
    "contourlets": ROOT / "packages/contourlets",
    "meshreaders": ROOT / "packages/meshreaders",
}

ISOLATED = """
import importlib.util, sys
sys.path.append(sys.argv[1])
assert importlib.util.find_spec("visuohaptic") is None
import numpy as np
import {name} as package
for name in package.__all__:
    assert getattr(package, name) is not None, name
assert not any(name.split(".")[0] == "visuohaptic" for name in sys.modules)
"""
USES = {
    "visuohaptic_attention": """
rows, columns = np.mgrid[:32, :32].astype(np.float32) / 32
flat = np.zeros_like(rows)
found = package.attend(
    colour=np.stack([rows, columns, flat], axis=-1)[None],
    mask=np.ones((1, 32, 32), bool),
    point=np.stack([rows, columns, flat], axis=-1)[None].astype(float),
    normal=np.broadcast_to([0.0, 0.0, 1.0], (1, 32, 32, 3)),
    face=np.zeros((1, 32, 32), np.int64),
    curvature=flat[None],
    parameters=package.AttentionParameters(fixations=2, focus_radius=0.1),
)
assert found[0].scanpath.distinct == 2
""",
    "contourlets": """
images = np.random.default_rng(0).random((2, 32, 32))
transform = package.Contourlet((4,))
assert np.allclose(transform.inverse(transform.forward(images)), images)
assert package.directional_deviations(images).shape == (2, 16)
assert {name.partition(".")[0] for name in sys.modules} & {"pywt", "scipy", "sklearn"} == set()
""",
    "meshreaders": """
assert {name.partition(".")[0] for name in sys.modules} & {"trimesh", "scipy", "open3d"} == set()
mesh = package.read(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
assert mesh.face_areas.tolist() == [0.5]
""",
}


def project_of(folder):
    return tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def requirements_of(folder, extras):
    """Return what a project asks for, with its extras, without itself."""
    project = project_of(folder)
    optional = project.get("optional-dependencies", {})
    lines = [*project["dependencies"], *(line for extra in extras for line in optional[extra])]
    return {line for line in lines if Requirement(line).name != project["name"]}


@pytest.fixture
def install(tmp_path):
    """Install a folder's wheel, with what it asks for and nothing else."""

    def installed(folder):
        ignored = shutil.ignore_patterns("__pycache__")
        source = shutil.copytree(folder, tmp_path / "source" / folder.name, ignore=ignored)
        site = tmp_path / "site"
        options = "--quiet --no-build-isolation --no-deps --no-index --disable-pip-version-check"
        subprocess.run(
            [sys.executable, "-m", "pip", "install", *options.split(), "--target", site, source],
            check=True,
        )
        link_installed(requirements_of(source, ()), site)
        return site

    return installed


def run_alone(program, *arguments, cwd):
    # -I -S: neither PYTHONPATH nor what is installed is searched.
    subprocess.run([sys.executable, "-I", "-S", "-c", program, *arguments], check=True, cwd=cwd)


@pytest.mark.slow
@pytest.mark.parametrize("name", FOLDERS)
def test_its_wheel_works_where_only_its_dependencies_are(name, install, tmp_path):
    site = install(FOLDERS[name])
    run_alone(ISOLATED.format(name=name) + USES[name], site, cwd=tmp_path)


@pytest.mark.parametrize("name", FOLDERS)
def test_its_dependencies_are_those_of_the_whole(name):
    own = project_of(FOLDERS[name]).get("optional-dependencies", ())
    assert requirements_of(FOLDERS[name], own) <= requirements_of(
        ROOT, project_of(ROOT)["optional-dependencies"]
    )
    assert project_of(FOLDERS[name])["requires-python"] == project_of(ROOT)["requires-python"]
