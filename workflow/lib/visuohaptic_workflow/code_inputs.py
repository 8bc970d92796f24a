"""Which files of this package a script runs, found from its imports without running it.

A workflow engine that watches a script does not see edits in the modules that it imports,
unless these files are inputs of the rule.
"""

from __future__ import annotations

import ast
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

PACKAGES = ("contourlets", "visuohaptic", "visuohaptic_workflow")
DATA_SUFFIXES = (".json", ".parquet")
"""Ends of files that hold figures which are kept with the package."""


def code_inputs(script: str | Path, sources: Iterable[str | Path]) -> list[Path]:
    """List the files of this project's packages that a script imports, directly or through others.

    Imports anywhere in a file count, those inside functions too; imports that
    only a type checker sees don't. Figures that lie beside a file that imports `importlib.resources`
    count, too: it reads them.

    Parameters
    ----------
    script : path
        A Python file.
    sources : iterable of path
        The folders that hold the packages.

    Returns
    -------
    list of pathlib.Path
        Sorted paths, below `sources`.
    """
    folders = tuple(Path(source) for source in sources)
    found: set[Path] = set()
    waiting = set(_imported_files(Path(script), folders))
    while waiting:
        file = waiting.pop()
        if file not in found:
            found.add(file)
            if file.suffix not in DATA_SUFFIXES:
                waiting |= _imported_files(file, folders)
    return sorted(found)


def _imported_files(file: Path, sources: tuple[Path, ...]) -> frozenset[Path]:
    found = file.stat()
    return _imported_files_of_version(file, sources, f"{found.st_mtime_ns} {found.st_size}")


@cache
def _imported_files_of_version(
    file: Path, sources: tuple[Path, ...], version: str
) -> frozenset[Path]:
    package = _package_of(file, sources)
    names, loads_lazily = _imports_of(file, version)
    files = _files_of((_absolute(level, name, package) for level, name in names), sources)
    if (0, "importlib.resources") in names:
        files |= {beside for beside in file.parent.iterdir() if beside.suffix in DATA_SUFFIXES}
    stub = file.with_suffix(".pyi")
    if loads_lazily and file.name == "__init__.py" and stub.exists():
        files.add(stub)
    return frozenset(files)


def _imports_of(file: Path, version: str) -> tuple[list[tuple[int, str]], bool]:
    """Give what a file imports, as level and name, and whether it loads its stub's names lazily.

    A workflow asks at each start; an answer is kept until the file changes.
    """
    known = _MEMORY.entries.get(str(file))
    if known is None or known[0] != version:
        tree = ast.parse(file.read_text(encoding="utf-8"), str(file))
        known = (version, sorted(set(_imported_names(tree))), _loads_lazily(tree))
        _MEMORY.entries[str(file)] = known
        _MEMORY.changed = True
    return [(level, name) for level, name in known[1]], known[2]


@dataclass
class _Memory:
    """What files import: version, imports and laziness of each."""

    entries: dict[str, Any] = field(default_factory=dict)
    changed: bool = False


_MEMORY = _Memory()


def load_memory(path: str | Path) -> None:
    """Take over what an earlier process found out about the imports of files.

    Parameters
    ----------
    path : path
        A file of `save_memory`; one that is missing or damaged is left alone.
    """
    with suppress(OSError, ValueError, AttributeError):
        _MEMORY.entries.update(json.loads(Path(path).read_text(encoding="utf-8")))


def save_memory(path: str | Path) -> None:
    """Keep what is known about the imports of files for later processes.

    Parameters
    ----------
    path : path
        The file; nothing is written where its folder is missing or nothing is new.
    """
    if _MEMORY.changed and Path(path).parent.is_dir():
        unfinished = Path(f"{path}.{os.getpid()}")
        unfinished.write_text(json.dumps(_MEMORY.entries), encoding="utf-8")
        unfinished.replace(path)
        _MEMORY.changed = False


def _loads_lazily(tree: ast.Module) -> bool:
    return any(
        isinstance(node, ast.Attribute) and node.attr == "attach_stub" for node in ast.walk(tree)
    )


def _package_of(file: Path, sources: tuple[Path, ...]) -> str:
    for source in sources:
        if source in file.parents:
            return ".".join(file.relative_to(source).parent.parts)
    return ""


def _imported_names(tree: ast.Module) -> Iterator[tuple[int, str]]:
    for node in _run_time_statements(tree):
        if isinstance(node, ast.Import):
            yield from ((0, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            yield node.level, base
            yield from ((node.level, f"{base}.{alias.name}".strip(".")) for alias in node.names)


def _absolute(level: int, name: str, package: str) -> str:
    """Give the full name of a module that is imported by a relative one."""
    if not level:
        return name
    parents = package.split(".")[: len(package.split(".")) - level + 1]
    return ".".join([*parents, name]).strip(".")


def _run_time_statements(tree: ast.Module) -> Iterator[ast.stmt]:
    """Give every statement at any depth; expressions, which hold no imports, aren't entered."""
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.stmt):
            yield node
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            waiting.extend(node.orelse)
            continue
        for block in ("body", "orelse", "finalbody", "handlers", "cases"):
            waiting.extend(getattr(node, block, ()))


def _files_of(names: Iterable[str], sources: tuple[Path, ...]) -> set[Path]:
    """Give the files of modules and the `__init__.py` of each package above them."""
    modules = {
        "/".join(parts[:depth])
        for parts in (name.split(".") for name in names)
        if parts[0] in PACKAGES
        for depth in range(1, len(parts) + 1)
    }
    # Thousands are asked for at each start: strings are several times faster than paths here.
    wanted = (
        f"{source}/{module}{end}"
        for source in sources
        for module in modules
        for end in (".py", "/__init__.py")
    )
    return {Path(file) for file in wanted if os.path.isfile(file)}  # noqa: PTH113
