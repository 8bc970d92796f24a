"""Which code a job runs: the modules that its script imports, directly or through others, and their packages."""

from __future__ import annotations

import ast
import os
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from visuohaptic.plugins import PlugIn

MACHINERY = "visuohaptic_workflow.jobs"
"""What every job has around its work; no number depends on it."""

FRONT_DOOR = "visuohaptic"
"""What users import, for every name at once; of it this project itself takes the version alone."""

ALWAYS = ("numpy", "scipy")
DISTRIBUTIONS = {
    "PIL": ("pillow",),
    "cv2": ("opencv-python-headless", "opencv-python"),
    "open3d": ("open3d-cpu", "open3d"),
    "pywt": ("PyWavelets",),
    "skimage": ("scikit-image",),
    "sklearn": ("scikit-learn",),
    "yaml": ("PyYAML",),
}
"""Packages whose module has another name."""

_NAMED = re.compile(r"\bFunction\(\s*\"([\w.]+):")
"""Functions by their names, which count as imports (`visuohaptic.functions`)."""


@dataclass(frozen=True)
class Start:
    """Where a job's code begins: a script, and `modules` that it runs by their names.

    `chosen` holds modules with a registry, each with those that the chosen entries name: the others count for nothing.
    """

    script: Path
    modules: tuple[str, ...] = ()
    chosen: tuple[tuple[str, frozenset[str]], ...] = ()


@dataclass(frozen=True)
class Code:
    """The files of this project that a job runs, its script among them, and the versions of other packages by name."""

    files: tuple[Path, ...]
    versions: dict[str, str]


@cache
def code_of(start: Start, sources: tuple[Path, ...]) -> Code:
    """Find what a job runs, of packages in the folders `sources` (`sys.path` has them, too) and of others by version.

    Imports anywhere count, those inside functions too, and functions by their names; what only a type checker sees
    does not. Data beside a module that imports `importlib.resources` counts, too.
    """
    packages = {file.parent.name for source in sources for file in source.glob("*/__init__.py")}
    graph = _graph(tuple(sorted(packages)))
    chosen = dict(start.chosen)
    files, others, seen = {start.script}, set(ALWAYS), {MACHINERY}
    waiting = _with_lazy({*start.modules, *_imports_of(start.script)}, sources)
    others |= {module.partition(".")[0] for module in waiting}
    while waiting:
        module = waiting.pop()
        if module in seen or module not in graph.modules:
            continue
        seen.add(module)
        file = _file_of(module, sources)
        if file is None:
            others.add(module.partition(".")[0])
            continue
        named = chosen[module] if module in chosen else _named_in(file)
        found = graph.find_modules_directly_imported_by(module) | named
        files.add(file)
        if "importlib" in found:
            files |= {one for one in file.parent.iterdir() if one.suffix in {".json", ".parquet"}}
        waiting |= {module.rpartition(".")[0]} | _with_lazy(found, sources)
    others -= {"", *sys.stdlib_module_names, *packages}
    return Code(tuple(sorted(files)), {name: version_of(name) for name in sorted(others)})


def with_plug_ins(code: Code, plug_ins: Iterable[PlugIn], sources: tuple[Path, ...]) -> Code:
    """Add to what a script runs those of the loaded plug-ins that registered with one of its modules.

    A file, relative to the working folder, counts with what it imports, an installed plug-in by its version.
    """
    files, versions = set(code.files), dict(code.versions)
    for plug_in in plug_ins:
        if {_file_of(home, sources) for home in plug_in.homes}.isdisjoint(code.files):
            continue
        if plug_in.file is None:
            versions[str(plug_in.package)] = version_of(str(plug_in.package))
            continue
        own = code_of(Start(plug_in.file), sources)
        files |= {*own.files, Path(os.path.relpath(plug_in.file))} - {plug_in.file}
        versions |= own.versions
    return Code(tuple(sorted(files)), dict(sorted(versions.items())))


@cache
def _graph(packages: tuple[str, ...]) -> Any:
    import grimp

    # Without its cache, which takes a file for unchanged by its time.
    return grimp.build_graph(
        *packages,
        include_external_packages=True,
        exclude_type_checking_imports=True,
        cache_dir=None,
    )


def _imports_of(file: Path, package: str = "") -> Iterator[str]:
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level:
            yield f"{package}.{node.module}"
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def _file_of(module: str, sources: tuple[Path, ...]) -> Path | None:
    paths = [source.joinpath(*module.split(".")) for source in sources]
    files = [file for path in paths for file in (path / "__init__.py", path.with_suffix(".py"))]
    return next((file for file in files if file.exists()), None)


@cache
def _named_in(file: Path) -> frozenset[str]:
    return frozenset(_NAMED.findall(file.read_text(encoding="utf-8")))


def _with_lazy(modules: Iterable[str], sources: tuple[Path, ...]) -> set[str]:
    """Add what packages load with the names that are taken of them, by the stub beside their `__init__`."""
    found = set(modules)
    for module in found - {FRONT_DOOR}:
        file = _file_of(module, sources)
        if file and file.name == "__init__.py" and (stub := file.with_suffix(".pyi")).exists():
            found = found.union(_imports_of(stub, module))
    return found


@cache
def version_of(module: str) -> str:
    """Give the version of the package that brings a module, or "none"."""
    for name in DISTRIBUTIONS.get(module, (module,)):
        try:
            return version(name)
        except PackageNotFoundError:
            continue
    return "none"
