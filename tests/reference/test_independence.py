"""The reference disagrees only if it does not use the package that it checks."""

import ast
from pathlib import Path

import pytest

CHECKED = {"visuohaptic", "visuohaptic_workflow", "contourlets", "meshreaders"}
MODULES = sorted(
    path for path in Path(__file__).parent.glob("*.py") if not path.name.startswith("test_")
)


def imported_packages(path):
    """Return the top-level packages that a module imports, anywhere in the module."""
    packages = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            packages |= {name.name.partition(".")[0] for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            packages.add((node.module or "").partition(".")[0])
        elif isinstance(node, ast.Name) and node.id in {"__import__", "importlib"}:
            packages.add(node.id)
    return packages


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.stem)
def test_reference_imports_nothing_of_the_package(path):
    assert not imported_packages(path) & (CHECKED | {"__import__", "importlib"})


@pytest.mark.parametrize(
    "line",
    ["import visuohaptic as vh", "from contourlets.pyramid import x", "from visuohaptic import y"],
)
def test_an_import_of_the_package_is_found(line, tmp_path):
    path = tmp_path / "module.py"
    path.write_text(f"def f():\n    {line}\n", encoding="utf-8")
    assert imported_packages(path) & CHECKED
