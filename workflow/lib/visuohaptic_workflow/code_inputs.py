"""Which files of this package a script runs, told from its imports without running it.

A workflow engine that watches a script sees no edit in what the script imports.
With these files among a rule's inputs it does.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

PACKAGES = ("visuohaptic", "visuohaptic_workflow")


def code_inputs(script: str | Path, sources: Iterable[str | Path]) -> list[Path]:
    """List the files of this project's packages that a script imports, directly or through others.

    Imports anywhere in a file count, those inside functions too; imports that
    only a type checker sees don't.

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
            waiting |= _imported_files(file, folders)
    return sorted(found)


def _imported_files(file: Path, sources: tuple[Path, ...]) -> frozenset[Path]:
    # A workflow asks once a rule, and most rules share most modules.
    return _imported_files_of_version(file, sources, file.stat().st_mtime_ns)


@cache
def _imported_files_of_version(
    file: Path, sources: tuple[Path, ...], _modified_ns: int
) -> frozenset[Path]:
    tree = ast.parse(file.read_text(encoding="utf-8"), str(file))
    files: set[Path] = set()
    for name in set(_imported_names(tree, _package_of(file, sources))):
        files |= _files_of(name, sources)
    stub = file.with_suffix(".pyi")
    if file.name == "__init__.py" and stub.exists() and _loads_lazily(tree):
        files.add(stub)
    return frozenset(files)


def _loads_lazily(tree: ast.Module) -> bool:
    return any(
        isinstance(node, ast.Attribute) and node.attr == "attach_stub" for node in ast.walk(tree)
    )


def _package_of(file: Path, sources: tuple[Path, ...]) -> str:
    for source in sources:
        if source in file.parents:
            return ".".join(file.relative_to(source).parent.parts)
    return ""


def _imported_names(tree: ast.Module, package: str) -> Iterator[str]:
    for node in _run_time_statements(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parents = package.split(".")[: len(package.split(".")) - node.level + 1]
            base = (
                ".".join([*parents, node.module or ""]).strip(".")
                if node.level
                else node.module or ""
            )
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


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


def _files_of(name: str, sources: tuple[Path, ...]) -> set[Path]:
    """Give the file of a module and the `__init__.py` of each package above it."""
    parts = name.split(".")
    if parts[0] not in PACKAGES:
        return set()
    files = set()
    for source in sources:
        files |= {
            source.joinpath(*parts[:depth], "__init__.py") for depth in range(1, len(parts) + 1)
        }
        files.add(source.joinpath(*parts).with_suffix(".py"))
    return {file for file in files if file.is_file()}
