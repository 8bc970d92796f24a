"""A job's key holds the folders that a table names for its rule; whatever its script imports lies there."""

import ast
import sys
from importlib.metadata import distributions, version
from pathlib import Path

import grimp
import pytest

from visuohaptic.base.errors import PlugInError
from visuohaptic.io.plugins import PlugIn
from visuohaptic.phases import PHASES
from visuohaptic.studies.registry import STUDIES
from visuohaptic_workflow.code_of_jobs import (
    ALWAYS,
    CODE,
    MOST_BESIDE,
    STEP,
    CodeError,
    Runs,
    code_of,
    files_beside,
    imports_of,
    module_of,
    version_of,
)

ROOT = Path(__file__).parents[2]
PACKAGES = [ROOT / f"packages/{name}/src" for name in ("contourlets", "meshreaders")]
SOURCES = [ROOT / "src", *PACKAGES, ROOT / "workflow/lib"]
LIBRARY = ROOT / "src/visuohaptic"
SCRIPTS = ROOT / "workflow/scripts"
SCRIPT = SCRIPTS / "features.py"
# What every job has around its work.
MACHINERY = "visuohaptic_workflow.jobs"


@pytest.fixture(scope="module")
def graph():
    packages = ("visuohaptic", "contourlets", "meshreaders", "visuohaptic_workflow")
    return grimp.build_graph(*packages, exclude_type_checking_imports=True, cache_dir=None)


@pytest.fixture(scope="module")
def whole_graph():
    packages = ("visuohaptic", "contourlets", "meshreaders", "visuohaptic_workflow")
    return grimp.build_graph(
        *packages,
        include_external_packages=True,
        exclude_type_checking_imports=True,
        cache_dir=None,
    )


def names_of(code):
    return {str(Path(file).resolve().relative_to(ROOT)) for file in code.files}


def is_named(module, row):
    places = map(module_of, (*ALWAYS, *row))
    parents = [module_of(place).rpartition(".")[0] for place in row]
    return any(f"{module}.".startswith(f"{place}.") for place in places) or module in parents


def start_of(rule):
    """Name the modules at which a rule's own code begins: what its script imports, or the module of a study's step."""
    script = SCRIPTS / f"{rule}.py"
    if not script.exists():
        steps = {step.name: step for study in STUDIES for step in study.steps}
        return {steps[rule].work.partition(":")[0]}
    nodes = [
        node for node in ast.parse(script.read_text()).body if isinstance(node, ast.ImportFrom)
    ]
    return {node.module for node in nodes} - {MACHINERY}


@pytest.mark.parametrize("rule", CODE)
def test_what_a_script_imports_lies_in_the_places_of_its_rule(graph, rule):
    start = start_of(rule) & graph.modules
    found = start.union(*(graph.find_upstream_modules(module) for module in start))
    library = {
        name for name in found if name.startswith(("visuohaptic.", "contourlets", "meshreaders."))
    }
    assert [name for name in sorted(library) if not is_named(name, CODE[rule])] == []


def test_every_place_of_the_table_is_there():
    for row in (*CODE.values(), STEP):
        assert names_of(code_of(Runs(SCRIPT, row), SOURCES))


@pytest.mark.parametrize("phase", [phase.name for phase in PHASES])
def test_what_a_folder_of_a_phase_imports_lies_in_the_places_of_its_rule(graph, phase):
    folder = f"visuohaptic.{phase}"
    modules = {folder, *graph.find_descendants(folder)}
    found = modules.union(*map(graph.find_upstream_modules, modules))
    library = {
        name for name in found if name.startswith(("visuohaptic.", "contourlets", "meshreaders."))
    }
    assert [name for name in sorted(library) if not is_named(name, CODE[phase])] == []


def test_a_folder_counts_with_its_data_and_a_module_alone(tmp_path):
    files = names_of(code_of(Runs(SCRIPT, CODE["fixations"]), SOURCES))
    assert {"src/visuohaptic/attention/human_weights.json", "workflow/scripts/features.py"} < files
    assert {file for file in files if "/tables/" in file} == {
        f"src/visuohaptic/tables/{name}.py" for name in ("__init__", "phases", "schema")
    }
    assert "src/visuohaptic/__init__.py" not in files


def test_versions_are_those_of_the_packages_that_the_folders_import():
    versions = code_of(Runs(SCRIPT, CODE["features"]), SOURCES).versions
    assert versions["pywt"] == version("PyWavelets")
    assert "cv2" not in versions
    assert not {"os", "visuohaptic", "contourlets", "meshreaders"} & {*versions}


@pytest.mark.parametrize(
    "place", sorted({place for row in CODE.values() for place in row} - {"__init__"})
)
def test_the_packages_of_a_place_are_those_that_an_import_graph_has(whole_graph, place):
    module = module_of(place)
    modules = {module, *whole_graph.find_descendants(module)} & whole_graph.modules
    if SOURCES[0].joinpath(*module.split(".")).with_suffix(".py").exists():
        modules = {module}
    imported = {
        name.partition(".")[0]
        for one in modules
        for name in whole_graph.find_modules_directly_imported_by(one)
    }
    ours = {"contourlets", "meshreaders", "visuohaptic", "visuohaptic_workflow"}
    always = code_of(Runs(SCRIPT, ()), SOURCES).versions
    found = code_of(Runs(SCRIPT, (place,)), SOURCES).versions
    assert {*found} - {*always} == imported - ours - {*sys.stdlib_module_names} - {*always}


def test_what_only_type_checkers_import_and_relative_imports_are_no_packages(tmp_path):
    (tmp_path / "a.py").write_text(
        "import typing\nif typing.TYPE_CHECKING:\n    import one\nelse:\n    import two.three\n"
        "from . import four\ndef work():\n    from five import six\n"
    )
    assert imports_of(tmp_path / "a.py") == ["five", "five.six", "two.three", "typing"]


def test_versions_are_those_of_the_packages_metadata():
    installed = {one.name for one in distributions()} - {
        "visuohaptic",
        "contourlets",
        "meshreaders",
    }
    assert {name: version_of(name) for name in installed} == {
        name: version(name) for name in installed
    }


TOY = {
    "toy/__init__.py": "",
    "toy/steps.py": "import yaml\ndef work():\n    from toy import helper\n",
    "toy/helper.py": "from importlib.resources import files\nimport other\n",
    "toy/section.py": "import jinja2\n",
    "toy/templates/page.html": "",
    "toy/templates/section.html.jinja": "",
    "toy/measured.json": "{}",
    "other.py": "",
    "unused.py": "",
}


UNUSED = {"toy/section.py", "toy/templates/section.html.jinja", "unused.py"}


@pytest.fixture
def toy(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in TOY.items():
        path = tmp_path / "studies" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "studies"


def test_of_a_study_counts_what_its_step_imports_and_not_its_section(toy):
    row = CODE["recognition"]
    plain = code_of(Runs(SCRIPT, row), SOURCES)
    found = code_of(Runs(SCRIPT, row, (toy / "toy/steps.py",)), SOURCES, [toy])
    names = {str(file) for file in set(found.files) - set(plain.files)}
    assert names == {f"studies/{name}" for name in TOY if name not in UNUSED}
    added = {name: found.versions[name] for name in set(found.versions) - set(plain.versions)}
    assert added == {"yaml": version("PyYAML")}


@pytest.mark.parametrize(
    ("text", "place", "is_whole"),
    [
        ("import visuohaptic as vh\n", "sensor", False),
        ("from visuohaptic.sensor.frames import row_axes\n", "sensor", True),
        ("from visuohaptic.report.drawing import style\n", "report", True),
    ],
)
def test_a_file_of_the_user_brings_the_places_that_it_imports(toy, text, place, is_whole):
    (toy / "other.py").write_text(text)
    found = names_of_library(
        code_of(Runs(SCRIPT, CODE["recognition"], (toy / "other.py",)), SOURCES)
    )
    whole = {str(file.relative_to(ROOT)) for file in (LIBRARY / place).rglob("*.py")}
    assert whole <= found if is_whole else whole.isdisjoint(found)


def names_of_library(code):
    return {str(file.relative_to(ROOT)) for file in code.files if file.is_absolute()}


@pytest.mark.parametrize(("rule", "homes"), [("recognition", 2), ("fixations", 1), ("meshes", 0)])
def test_a_plug_in_is_code_of_the_jobs_that_run_what_it_registered_with(toy, rule, homes):
    for name, text in {
        "mine.py": "import tqdm\nimport other\nimport helper\n",
        "helper.py": "import psutil\n",
        "data/numbers.json": "[]",
        "of_another.py": "",
        ".hidden": "",
        "__pycache__/helper.pyc": "",
    }.items():
        path = Path("plug_ins", name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    strategies, maps = "visuohaptic.fixations.probing", "visuohaptic.recognition.maps"
    mine = PlugIn(str(Path("plug_ins/mine.py").absolute()), frozenset({strategies, maps}))
    other = PlugIn(
        str(Path("plug_ins/of_another.py").absolute()), frozenset({"visuohaptic.report"})
    )
    installed = PlugIn("mine.installed", frozenset({maps}), "pytest")
    plain = code_of(Runs(SCRIPT, CODE[rule]), SOURCES)
    found = code_of(Runs(SCRIPT, CODE[rule]), SOURCES, [toy], [mine, other, installed])
    added = {str(file) for file in set(found.files) - set(plain.files)}
    beside = {f"plug_ins/{name}" for name in ("mine.py", "helper.py", "data/numbers.json")}
    assert added == ({*beside, "studies/other.py"} if homes else set())
    if homes:
        assert found.versions["psutil"] == version("psutil")
        assert found.versions["tqdm"] == version("tqdm")
    assert found.versions.get("pytest") == (version("pytest") if homes == 2 else None)


@pytest.mark.parametrize(
    ("rule", "counts"), [("fixations", False), ("touches", True), ("stability_of_object", False)]
)
def test_policies_are_code_of_touches_and_not_of_fixations(toy, rule, counts):
    plug_in = Path("plug_ins/mine.py")
    plug_in.parent.mkdir()
    plug_in.touch()
    registries = frozenset({"visuohaptic.active.registry"})
    mine = PlugIn(str(plug_in.absolute()), registries)
    found = code_of(Runs(SCRIPT, CODE[rule]), SOURCES, [toy], [mine])
    assert (plug_in in found.files) == counts
    assert ("src/visuohaptic/active/seek_relief.py" in names_of_library(found)) == counts


def test_a_plug_in_without_a_folder_of_its_own_is_refused(tmp_path, monkeypatch):
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)
    for plug_in in (folder / "mine.py", tmp_path / "mine.py"):
        with pytest.raises(
            PlugInError,
            match=f"mine.py needs a folder of its own, .* {plug_in.parent} contains the results",
        ):
            files_beside(plug_in)
    many = tmp_path / "many"
    many.mkdir()
    for number in range(MOST_BESIDE + 1):
        (many / f"{number}.txt").touch()
    with pytest.raises(PlugInError, match=r"many has more than 1000 files"):
        files_beside(many / "mine.py")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"a = 1\ndef broken(:\n", r", line 2 can't be read as Python: invalid syntax\.$"),
        (b"a = '\xff'\n", r" can't be read as Python: .*codec can't decode"),
        (b"a = 1\0\n", r" can't be read as Python: source code .*null bytes"),
    ],
)
def test_code_that_is_no_python_is_named(tmp_path, content, reason):
    (tmp_path / "a.py").write_bytes(content)
    with pytest.raises(CodeError, match=f"{tmp_path}/a.py{reason}"):
        imports_of(tmp_path / "a.py")
