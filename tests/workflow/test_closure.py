"""The modules that a script runs are found without running it."""

import sys
from importlib.metadata import version
from pathlib import Path

import pytest

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import OF_OBJECT, PHASES
from visuohaptic.plugins import PlugIn
from visuohaptic_workflow.closure import Start, code_of, with_plug_ins

ROOT = Path(__file__).parents[2]
FILES = {
    "__init__.py": "",
    "a.py": "from toyhand.b import x\nimport yaml\n",
    "b.py": "def f():\n    from toyhand import c\n",
    "c.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import toyhand.d\n",
    "d.py": "import importlib.resources\n",
    "figures.json": "{}",
    "lazy/__init__.py": "import lazy_loader\nx = lazy_loader.attach_stub(__name__, __file__)\n",
    "lazy/__init__.pyi": "from .one import x as x\n",
    "lazy/one.py": "from .two import y\n",
    "lazy/two.py": "from ..d import z\n",
}


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    source = tmp_path_factory.mktemp("toy") / "src"
    for name, text in FILES.items():
        path = source / "toyhand" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    sys.path.insert(0, str(source))
    yield source
    sys.path.remove(str(source))


@pytest.mark.parametrize(
    ("text", "names"),
    [
        # Into functions, but not for the type checker.
        ("import toyhand.a", {"a.py", "b.py", "c.py"}),
        # With data beside a module that reads some.
        ("from toyhand import d", {"d.py", "figures.json"}),
        # What the stub of a lazy package names.
        (
            "from toyhand.lazy import x",
            {"lazy/__init__.py", "lazy/one.py", "lazy/two.py", "d.py", "figures.json"},
        ),
    ],
)
def test_imports_are_followed(source, tmp_path, text, names):
    script = tmp_path / "script.py"
    script.write_text(text)
    found = code_of(Start(script), (source,))
    files = {source / "toyhand" / name for name in ("__init__.py", *names)}
    assert set(found.files) == {script, *files}
    assert found.versions.get("yaml") == (version("PyYAML") if "a.py" in names else None)


@pytest.mark.parametrize(
    ("text", "homes"), [("import toyhand.a", 2), ("import toyhand.c", 1), ("import toyhand.d", 0)]
)
def test_a_plug_in_is_code_of_the_scripts_that_run_what_it_registered_with(
    source, tmp_path, monkeypatch, text, homes
):
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text("import sklearn\nfrom toyhand import d\n")
    mine = PlugIn(str(tmp_path / "mine.py"), frozenset({"toyhand.c"}))
    installed = PlugIn("mine.installed", frozenset({"toyhand.b"}), "pytest")
    script = tmp_path / "script.py"
    script.write_text(text)
    plain = code_of(Start(script), (source,))
    found = with_plug_ins(plain, [mine, installed], (source,))
    added = {Path(file).name for file in set(found.files) - set(plain.files)}
    assert added == ({"mine.py", "d.py", "figures.json"} if homes else set())
    assert ("sklearn" in found.versions) == (homes > 0)
    assert found.versions.get("pytest") == (version("pytest") if homes == 2 else None)


SOURCES = (ROOT / "src", ROOT / "workflow/lib", ROOT / "packages/contourlets/src")


def files_of(start):
    return {str(file.relative_to(ROOT)) for file in code_of(start, SOURCES).files}


def code_of_phase(phase, values=None):
    chosen = phase.chosen_modules(ExperimentParameters.from_mapping(values or {}))
    script = ROOT / "workflow/scripts/phase.py"
    return files_of(Start(script, (phase.work.module,), tuple(chosen.items())))


@pytest.mark.parametrize("phase", OF_OBJECT, ids=lambda phase: phase.name)
def test_a_phase_runs_its_own_code_and_not_that_of_other_phases_or_of_jobs(phase):
    files = code_of_phase(phase)
    folders = {Path(file).parts[2] for file in files if file.startswith("src/visuohaptic/")}
    assert folders & {one.name for one in PHASES} == {phase.name}
    assert not {"src/visuohaptic/pipeline.py", "src/visuohaptic/parameters.py"} & files
    assert "workflow/lib/visuohaptic_workflow/jobs.py" not in files


@pytest.mark.parametrize("strategies", [["fixation"], ["curvature"], ["random_walk", "contour"]])
def test_a_strategy_is_code_of_the_runs_alone_that_use_it(strategies):
    files = code_of_phase(OF_OBJECT[0], {"probing": {"strategies": strategies}})
    folder = "src/visuohaptic/fixations/strategies/"
    used = {file for file in files if file.startswith(folder)}
    assert used == {f"{folder}{name}.py" for name in ("__init__", *strategies)}


def test_functions_by_their_names_are_code_of_what_names_them():
    files = files_of(Start(ROOT / "workflow/scripts/features_of_study.py"))
    strategies = ROOT.glob("src/visuohaptic/fixations/strategies/*.py")
    assert files >= {str(file.relative_to(ROOT)) for file in strategies}
    assert "src/visuohaptic/touches/touching.py" in files
