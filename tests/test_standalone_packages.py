"""`contourlet` and `attention` can each be published alone: they use nothing of the rest."""

import ast
import doctest
import importlib
import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
LIBRARY = ROOT / "src" / "visuohaptic"
NAMES = ("attention", "contourlet")
MODULES = [(name, path.stem) for name in NAMES for path in sorted((LIBRARY / name).glob("*.py"))]

ISOLATED = """
import importlib.util, sys
sys.path.append(sys.argv[1])
assert importlib.util.find_spec("visuohaptic") is None
import numpy as np
import visuohaptic_{name} as package
for name in package.__all__:
    assert getattr(package, name) is not None, name
assert not any(name.split(".")[0] == "visuohaptic" for name in sys.modules)
"""
USES = {
    "attention": """
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
assert package.area_under_curve(rows, rows > 0.5, rows >= 0) == 1
""",
    "contourlet": """
images = np.random.default_rng(0).random((2, 32, 32))
transform = package.Contourlet((4,))
assert np.allclose(transform.inverse(transform.forward(images)), images)
assert package.ContourletDeviations().fit_transform(images).shape == (2, 16)
assert package.wavelet_deviations(images).shape == (2, 9)
""",
}


def project_of(folder):
    return tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def requirements_of(project):
    extras = project.get("optional-dependencies", {}).values()
    return [*project["dependencies"], *(line for lines in extras for line in lines)]


def link_installed(requirements, folder):
    """Link the distributions that are required, and those that they require, into a folder."""
    waiting, linked = [Requirement(line) for line in requirements], set()
    while waiting:
        requirement = waiting.pop()
        if requirement.name in linked or (
            requirement.marker and not requirement.marker.evaluate({"extra": ""})
        ):
            continue
        linked.add(requirement.name)
        installed = distribution(requirement.name)
        waiting += map(Requirement, installed.requires or [])
        for top in {file.parts[0] for file in installed.files} - {"..", "__pycache__"}:
            if not (folder / top).exists():
                (folder / top).symlink_to(installed.locate_file(top))


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_its_wheel_works_where_only_its_dependencies_are(name, tmp_path):
    ignored = shutil.ignore_patterns("__pycache__")
    source = shutil.copytree(LIBRARY / name, tmp_path / "source" / name, ignore=ignored)
    site = tmp_path / "site"
    options = "--quiet --no-build-isolation --no-deps --no-index --disable-pip-version-check"
    subprocess.run(
        [sys.executable, "-m", "pip", "install", *options.split(), "--target", site, source],
        check=True,
    )
    link_installed(requirements_of(project_of(source)), site)
    # -I -S: neither PYTHONPATH nor what is installed is searched.
    program = ISOLATED.format(name=name) + USES[name]
    subprocess.run([sys.executable, "-I", "-S", "-c", program, site], check=True, cwd=tmp_path)


@pytest.mark.parametrize("name", NAMES)
def test_its_dependencies_are_those_of_the_whole(name):
    whole = project_of(ROOT)
    own = project_of(LIBRARY / name)
    assert set(requirements_of(own)) <= set(whole["dependencies"])
    assert own["requires-python"] == whole["requires-python"]


@pytest.mark.parametrize(("name", "module"), MODULES)
def test_its_own_modules_are_imported_by_relative_names(name, module):
    tree = ast.parse((LIBRARY / name / f"{module}.py").read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            assert not any(alias.name.startswith("visuohaptic") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level < 2
            assert node.level or not node.module.startswith("visuohaptic")


@pytest.mark.parametrize(("name", "module"), MODULES)
def test_examples_in_docstrings_run(name, module):
    path = f"visuohaptic.{name}" if module == "__init__" else f"visuohaptic.{name}.{module}"
    assert doctest.testmod(importlib.import_module(path)).failed == 0
