"""The lock files hold what pyproject.toml asks for and what the code imports, each package with its hashes."""

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
EXTRAS = PROJECT["project"]["optional-dependencies"]
TO_RUN = [
    *PROJECT["project"]["dependencies"],
    *EXTRAS["workflow"],
    *EXTRAS["report"],
    *PROJECT["dependency-groups"]["build"],
]
TO_DEVELOP = [
    *TO_RUN,
    *(wanted for name in ("s3", "environment", "dev") for wanted in EXTRAS[name]),
]
OWN = {"contourlets", "meshreaders", "visuohaptic", "visuohaptic_workflow"}
# Files that import packages of an extra, and the file that refuses in a sentence without these.
OF_AN_EXTRA = {
    f"{folder}/{start}": (extra, f"{folder}/{refusing}")
    for folder, start, extra, refusing in (
        ("src/visuohaptic", "environment/", "environment", "environment/__init__.py"),
        ("src/visuohaptic", "geometry/compiled_open3d.py", "open3d", "geometry/compiled_open3d.py"),
        ("src/visuohaptic", "report/", "report", "cli/report.py"),
        ("src/visuohaptic", "report/compare_runs.py", "workflow", "report/compare_runs.py"),
    )
}
# What comes with a package that is asked for and is imported beside it: versions that fit are its business.
BROUGHT_BY = {
    "markupsafe": "jinja2",
    "pydantic-core": "pydantic",
    "snakemake-interface-logger-plugins": "snakemake",
}
SOURCES = sorted(
    path
    for folder in ("src", "workflow")
    for path in (ROOT / folder).rglob("*")
    if path.suffix in {".py", ".pyi", ".smk"} or path.name == "Snakefile"
)


def pinned(lock):
    """Return the versions of each package of a lock file."""
    found = {}
    for name, version in re.findall(r"^([\w.-]+)==(\S+)", (ROOT / lock).read_text(), re.M):
        found.setdefault(canonicalize_name(name), set()).add(version)
    return found


@pytest.mark.parametrize(
    ("lock", "wanted"), [("requirements.lock", TO_RUN), ("requirements-dev.lock", TO_DEVELOP)]
)
def test_a_lock_pins_every_dependency_at_a_version_that_is_allowed(lock, wanted):
    versions = pinned(lock)
    for requirement in map(Requirement, wanted):
        if requirement.name not in OWN:
            found = versions.get(canonicalize_name(requirement.name), set())
            assert any(map(requirement.specifier.contains, found)), f"{requirement}: make lock"


def test_what_runs_is_pinned_at_the_same_versions_for_development():
    developed = pinned("requirements-dev.lock")
    for name, versions in pinned("requirements.lock").items():
        assert versions <= developed[name], name


def imported_packages(path):
    """Return the packages of others that a file imports, at its top or late, by the name imported."""
    if path.suffix not in {".py", ".pyi"}:
        found = set(re.findall(r"^ *(?:import|from) (\w+)", path.read_text(), re.M))
        return found - sys.stdlib_module_names - OWN
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        match node:
            case ast.Import():
                found |= {name.name for name in node.names}
            case ast.ImportFrom(level=0):
                found.add(node.module)
            case ast.Call(
                func=ast.Attribute(attr="find_spec" | "import_module"),
                args=[ast.Constant(value=str(name)), *_],
            ):
                found.add(name)
    return {name.partition(".")[0] for name in found} - sys.stdlib_module_names - OWN


def names_of(requirements):
    return {canonicalize_name(Requirement(one).name) for one in requirements}


def extras_of(path):
    """Return the extras whose packages a file may import beside those of the core."""
    place = path.relative_to(ROOT).as_posix()
    extras = {extra for start, (extra, _) in OF_AN_EXTRA.items() if place.startswith(start)}
    return extras | ({"workflow", "report"} if place.startswith("workflow/") else set())


def imports_without_a_requirement():
    """List what sources import and neither the core nor an extra that they may use asks for."""
    distributions = packages_distributions()
    # Packages of extras that `make` does not install are pinned for development only.
    locked, developed = (set(pinned(f"requirements{kind}.lock")) for kind in ("", "-dev"))
    for path in SOURCES:
        extras = extras_of(path)
        of_extras = names_of(one for extra in extras for one in EXTRAS[extra])
        allowed = (names_of(PROJECT["project"]["dependencies"]) & locked) | (of_extras & developed)
        for name in imported_packages(path):
            # What isn't installed can only be looked for by the name imported.
            own = {canonicalize_name(found) for found in distributions.get(name, [name])}
            if not allowed & (own | {BROUGHT_BY.get(found) for found in own}):
                yield f"{path.relative_to(ROOT)} imports {name}"


def test_every_import_is_of_a_package_that_is_asked_for_and_locked():
    assert len(SOURCES) > 250
    assert list(imports_without_a_requirement()) == []


@pytest.mark.parametrize(("extra", "refusing"), sorted(set(OF_AN_EXTRA.values())))
def test_what_needs_an_extra_says_so(extra, refusing):
    calls = [
        node.args[0].value
        for node in ast.walk(ast.parse((ROOT / refusing).read_text()))
        if isinstance(node, ast.Call)
        and getattr(node.func, "id", None) in {"require", "missing_packages"}
    ]
    assert extra in calls


@pytest.mark.parametrize(("name", "bringer"), BROUGHT_BY.items())
def test_what_comes_with_another_package_is_asked_for_by_it(name, bringer):
    assert name in names_of(requires(bringer))


def test_no_study_of_the_repository_is_imported_by_the_library_and_all_are_type_checked():
    studies = {path.parent.name for path in (ROOT / "studies").glob("*/study.py")}
    forbidden = {
        module
        for contract in PROJECT["tool"]["importlinter"]["contracts"]
        if contract.get("source_modules") == ["visuohaptic"]
        for module in contract["forbidden_modules"]
    }
    assert studies <= forbidden
    assert studies <= set(PROJECT["tool"]["mypy"]["packages"])


def test_one_table_says_what_each_package_is_for():
    text = (ROOT / "docs/decisions.md").read_text(encoding="utf-8").split("## Packages")[1]
    rows = [line.split(" | ") for line in text.splitlines() if line.startswith("| ")][1:]
    assert all(purpose.strip() for _, purpose, *_ in rows)
    named = {canonicalize_name(name) for cells in rows for name in cells[0].strip("| ").split(", ")}
    wanted = {
        canonicalize_name(Requirement(text).name)
        for texts in (PROJECT["project"]["dependencies"], *EXTRAS.values())
        for text in texts
    }
    assert named == wanted - {"visuohaptic"}
