"""The modules that a script runs are found without running it."""

from pathlib import Path

import pytest
from source_folders import PYTHONPATH, SOURCES

from visuohaptic_workflow.code_inputs import (
    _MEMORY,
    code_inputs,
    load_memory,
    save_memory,
)

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "workflow" / "scripts").glob("*.py"))


@pytest.fixture
def source(tmp_path):
    files = {
        "__init__.py": "",
        "a.py": "from visuohaptic.b import x\n",
        "b.py": "def f():\n    from visuohaptic import c\n",
        "c.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import visuohaptic.d\n",
        "d.py": "",
        "lazy/__init__.py": "import lazy_loader\nx = lazy_loader.attach_stub(__name__, __file__)\n",
        "lazy/__init__.pyi": "from .one import x as x\n",
        "lazy/one.py": "from .two import y\n",
        "lazy/two.py": "from ..d import z\n",
    }
    for name, text in files.items():
        path = tmp_path / "src" / "visuohaptic" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "src"


def found(source, text):
    script = source.parent / "script.py"
    script.write_text(text)
    return {str(file.relative_to(source / "visuohaptic")) for file in code_inputs(script, [source])}


def test_imports_are_followed_into_functions_but_not_for_the_type_checker(source):
    assert found(source, "import visuohaptic.a\n") == {"__init__.py", "a.py", "b.py", "c.py"}


def test_a_lazy_package_brings_what_its_stub_names(source):
    assert found(source, "from visuohaptic.lazy import x\n") == {
        "__init__.py", "d.py", "lazy/__init__.py", "lazy/__init__.pyi", "lazy/one.py", "lazy/two.py",
    }  # fmt: skip


def test_what_is_remembered_is_what_would_be_found_again(source, tmp_path):
    expected = found(source, "import visuohaptic.a\n")
    save_memory(tmp_path / "imports.json")
    _MEMORY.entries.clear()
    load_memory(tmp_path / "imports.json")
    assert str(source / "visuohaptic/a.py") in _MEMORY.entries
    assert found(source, "import visuohaptic.a\n") == expected
    (source / "visuohaptic/b.py").write_text("import visuohaptic.d\n")
    assert "d.py" in found(source, "import visuohaptic.a\n")


def test_a_damaged_memory_is_left_alone(source, tmp_path):
    (tmp_path / "imports.json").write_text("[1, 2")
    load_memory(tmp_path / "imports.json")
    assert "a.py" in found(source, "import visuohaptic.a\n")


def test_other_packages_do_not_count(source):
    assert found(source, "import numpy\nfrom os import path\n") == set()


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_every_module_that_a_script_loads_is_among_its_code_inputs(script):
    """Run the imports of a script for real, and compare with what is told from its text."""
    import ast
    import json
    import subprocess
    import sys

    imports = [
        ast.unparse(node)
        for node in ast.parse(script.read_text()).body
        if isinstance(node, ast.Import | ast.ImportFrom)
    ]
    program = "\n".join(
        [
            *imports,
            "import json, sys",
            "print(json.dumps([m.__file__ for n, m in sys.modules.items() if n.startswith(('contourlets', 'visuohaptic'))]))",
        ]
    )
    output = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True, text=True, check=True, env={"PYTHONPATH": PYTHONPATH},
    ).stdout  # fmt: skip
    loaded = {Path(file) for file in json.loads(output.splitlines()[-1])}
    assert loaded <= set(code_inputs(script, SOURCES))


@pytest.mark.parametrize(
    ("phase", "folders"),
    [
        ("meshes", {"meshes"}),
        ("fixations", {"fixations", "attention"}),
        ("touches", {"touches", "sensor"}),
        ("features", {"features"}),
        ("recognition", {"recognition"}),
        ("model", {"model", "recognition"}),
    ],
)
def test_a_phase_runs_nothing_of_another_phase(phase, folders):
    """An edit in one phase must not rerun those before it; they share the floor below alone."""
    shared = {"geometry", "scene", "tables"}
    package = ROOT / "src" / "visuohaptic"
    files = code_inputs(ROOT / f"workflow/scripts/{phase}.py", SOURCES)
    below = [file.relative_to(package).parts for file in files if package in file.parents]
    assert {parts[0] for parts in below if len(parts) > 1} - shared == folders
    contourlets = {file.stem for file in files if "contourlets" in file.parts}
    assert ("lattice" in contourlets) == (phase == "features")
    assert "transformer" not in contourlets


def test_figures_beside_a_module_that_reads_them_count_as_code(tmp_path):
    package = tmp_path / "visuohaptic"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "learnt.py").write_text("from importlib.resources import files\n")
    (package / "plain.py").write_text("import json\n")
    (package / "weights.json").write_text("{}")
    (package / "notes.txt").touch()
    script = tmp_path / "script.py"
    script.write_text("import visuohaptic.learnt\n")
    assert package / "weights.json" in code_inputs(script, [tmp_path])
    assert package / "notes.txt" not in code_inputs(script, [tmp_path])
    script.write_text("import visuohaptic.plain  # reads nothing\n")
    assert package / "weights.json" not in code_inputs(script, [tmp_path])


def test_the_weights_fitted_to_people_are_code_of_the_fixations():
    root = Path(__file__).parents[2]
    found = code_inputs(root / "workflow/scripts/fixations.py", [root / "src"])
    assert root / "src/visuohaptic/attention/human_weights.json" in found
