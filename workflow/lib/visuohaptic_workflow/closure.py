"""Which code a job runs: the modules that its script imports, directly or through others, and their packages."""

from __future__ import annotations

import ast
import os
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
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

_DATA = (".json", ".parquet")
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
    packages = {
        package.name: package
        for source in sources
        for package in source.iterdir()
        if (package / "__init__.py").exists()
    }
    graph = _graph(tuple(sorted(packages)))
    files, others, chosen = {start.script}, set(ALWAYS), dict(start.chosen)
    direct = {*start.modules, *_imports_of(start.script.read_text(encoding="utf-8"))} - {MACHINERY}
    waiting = direct | {name for one in direct for name in _lazy_modules(one, packages)}
    seen: set[str] = set()
    while waiting:
        module = waiting.pop()
        top = module.partition(".")[0]
        if module in seen or not graph.modules >= {module}:
            continue
        seen.add(module)
        if top not in packages:
            others |= {top} - sys.stdlib_module_names
            continue
        waiting |= {module.rpartition(".")[0]} - {""}
        file = _file_of(module, packages)
        named = chosen[module] if module in chosen else _named_in(file)
        found = graph.find_modules_directly_imported_by(module) | named
        files |= {file, *(_data_beside(file) if "importlib" in found else ())}
        waiting |= found | {name for one in found for name in _lazy_modules(one, packages)}
    return Code(tuple(sorted(files)), {name: version_of(name) for name in sorted(others)})


def with_plug_ins(code: Code, plug_ins: Iterable[PlugIn], sources: tuple[Path, ...]) -> Code:
    """Add to what a script runs those of the loaded plug-ins that registered with one of its modules.

    A file, relative to the working folder, counts with what it imports, an installed plug-in by its version.
    """
    files, versions = set(code.files), dict(code.versions)
    for plug_in in plug_ins:
        if not {_module_file(home, sources) for home in plug_in.homes} & set(code.files):
            continue
        if plug_in.file is None:
            versions[str(plug_in.package)] = version_of(str(plug_in.package))
            continue
        own = code_of(Start(plug_in.file), sources)
        files |= {*own.files, Path(os.path.relpath(plug_in.file))} - {plug_in.file}
        names = _imports_of(plug_in.file.read_text(encoding="utf-8"))
        packages = {package.name for source in sources for package in source.iterdir()}
        others = {name.partition(".")[0] for name in names} - sys.stdlib_module_names - packages
        versions |= own.versions | {name: version_of(name) for name in others}
    return Code(tuple(sorted(files)), dict(sorted(versions.items())))


def _module_file(module: str, sources: tuple[Path, ...]) -> Path:
    paths = [source.joinpath(*module.split(".")).with_suffix(".py") for source in sources]
    return next((path for path in paths if path.exists()), paths[0])


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


def _imports_of(text: str, package: str = "") -> Iterator[str]:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level:
            yield f"{package}.{node.module}"
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _file_of(module: str, packages: dict[str, Path]) -> Path:
    top, _, rest = module.partition(".")
    path = packages[top].joinpath(*rest.split(".")) if rest else packages[top]
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def _named_in(file: Path) -> frozenset[str]:
    return frozenset(_NAMED.findall(file.read_text(encoding="utf-8")))


def _data_beside(file: Path) -> list[Path]:
    return [beside for beside in file.parent.iterdir() if beside.suffix in _DATA]


def _lazy_modules(module: str, packages: dict[str, Path]) -> Sequence[str]:
    """List what a package loads with the names that are taken of it, by the stub beside its `__init__`."""
    if module == FRONT_DOOR or module.partition(".")[0] not in packages:
        return ()
    stub = _file_of(module, packages).with_suffix(".pyi")
    if stub.name != "__init__.pyi" or not stub.exists():
        return ()
    return tuple(_imports_of(stub.read_text(encoding="utf-8"), module))


@cache
def version_of(module: str) -> str:
    """Give the version of the package that brings a module, or "none"."""
    for name in DISTRIBUTIONS.get(module, (module,)):
        try:
            return version(name)
        except PackageNotFoundError:
            continue
    return "none"
