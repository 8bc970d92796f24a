"""The command as a whole."""

import tomllib
from pathlib import Path

import pytest

import visuohaptic as package

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())


@pytest.mark.parametrize("arguments", [["--version"], ["--version", "touch", "mug.obj"]])
def test_the_version_is_that_of_the_package(visuohaptic, arguments):
    ended = visuohaptic(*arguments)
    assert (ended.code, ended.out) == (0, f"visuohaptic {package.__version__}\n")


def test_the_version_is_written_in_one_place():
    assert "version" not in PROJECT["project"]
    assert PROJECT["tool"]["hatch"]["version"]["path"] == "src/visuohaptic/__init__.py"
