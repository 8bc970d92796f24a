import ast
import doctest
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

from visuohaptic import contourlet

FOLDER = Path(contourlet.__file__).parent
MODULES = sorted(path.stem for path in FOLDER.glob("*.py") if path.stem != "__init__")


def imported_by(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "" if node.level else node.module.split(".")[0]


def test_package_stands_on_numpy_and_pywavelets_alone():
    allowed = {"", "numpy", "pywt", "lazy_loader", *sys.stdlib_module_names}
    for module in MODULES:
        found = set(imported_by(FOLDER / f"{module}.py"))
        assert found <= allowed | ({"sklearn"} if module == "transformer" else set()), module


def test_package_speaks_of_images_alone():
    for path in FOLDER.glob("*.py*"):
        text = path.read_text(encoding="utf-8").lower()
        assert not any(word in text for word in ("touch", "tactile", "imprint", "taxel")), path


def test_all_that_is_promised_is_there():
    for name in contourlet.__all__:
        assert getattr(contourlet, name) is not None


def test_deviations_load_nothing_heavy():
    program = (
        "import sys, numpy; from visuohaptic.contourlet import directional_deviations;"
        "directional_deviations(numpy.zeros((1, 32, 32)));"
        "sys.exit(any(m in sys.modules for m in ('sklearn', 'scipy', 'pywt', 'pandas')))"
    )
    subprocess.run(
        [sys.executable, "-c", program], env={"PYTHONPATH": ":".join(sys.path)}, check=True
    )


@pytest.mark.parametrize("module", MODULES)
def test_examples_in_docstrings_run(module):
    result = doctest.testmod(importlib.import_module(f"visuohaptic.contourlet.{module}"))
    assert result.failed == 0
