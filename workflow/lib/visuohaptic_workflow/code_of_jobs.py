"""Which code is part of a job's key: folders of the library by rule, files of the user with what they import, versions."""

from __future__ import annotations

import ast
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution, version
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from visuohaptic.io.plugins import PlugIn

LIBRARY = "visuohaptic"
ALWAYS = ("base",)
"""What every row of `CODE` has beside its own places."""

_TABLES = ("tables.phases", "tables.schema")
_BY_OBJECT = ("io.phase_files", "visuohaptic_workflow.phase_jobs", "geometry", *_TABLES)
_EYE = ("fixations", "attention", "scene", *_BY_OBJECT)
_HAND = ("touches", "sensor", *_EYE)
_DESCRIBING = ("features", "contourlets", *_BY_OBJECT)
_PHASES = (
    "meshes",
    *_EYE,
    *_HAND,
    *_DESCRIBING,
    "recognition",
    "io",
    "parameters",
    "phases",
    "pipeline",
)
_STUDIES = (
    "studies.conditions",
    "studies.measuring",
    "studies.recomputing",
    "studies.refusals",
    "studies.study",
    "tables.studies",
)
_MEASURING = (*_PHASES, *_STUDIES)
STEP = (*_PHASES, "evaluation", "studies", "tables")
"""The row of a study's step that has none by its name: all that lies below the report."""

CODE = {
    "downloads": ("meshes", "geometry"),
    "credits": ("meshes", "geometry"),
    "meshes": ("meshes", "geometry"),
    "fixations": _EYE,
    "touches": _HAND,
    "features": _DESCRIBING,
    "recognition": ("recognition", *_TABLES),
    "model": ("recognition", "__init__", *_TABLES),
    "metrics": ("evaluation", "recognition", "tables.studies", *_TABLES),
    "stability_of_object": ("stability", "contourlets", "tables.stability", *_HAND),
    "features_of_study": _MEASURING,
    "block_of_study": _MEASURING,
    "figures_of_study": ("studies.figures", "evaluation", "recognition", "tables.studies", *_TABLES),
    "frontier_seconds": ("studies.cost.seconds", "studies.cost.settings", *_MEASURING),
    "frontier": STEP,
    "effect_influence": ("studies.effects.influence", *_MEASURING),
    "pictures": (
        "report.object_pictures", "report.models", "report.pictures", "geometry", "tables",
    ),
    "report": (*STEP, "report", "stability", "__init__", "visuohaptic_workflow.studies_asked"),
}  # fmt: skip
"""Folders and modules of the library by rule: an edit of any file there makes the rule's jobs run again.

A name is that of a folder or a module below src/visuohaptic, or of another package of this project. The contracts of
import-linter, in pyproject.toml, forbid each phase what its row does not name.
"""

_DISTRIBUTIONS = {
    "PIL": ("pillow",),
    "cv2": ("opencv-contrib-python-headless", "opencv-python-headless", "opencv-python"),
    "open3d": ("open3d-cpu", "open3d"),
    "pywt": ("PyWavelets",),
    "skimage": ("scikit-image",),
    "sklearn": ("scikit-learn",),
    "yaml": ("PyYAML",),
}
"""Packages whose module has another name."""


_OF_REPORT = {"section.html.jinja"}
"""Beside a study's own templates; it is a source of the report."""


@dataclass(frozen=True)
class Runs:
    """What a job runs: a script, places of the library (see `CODE`), and `own` files outside of the library.

    These are modules of studies; what they import counts, too.
    """

    script: Path
    places: tuple[str, ...]
    own: tuple[Path, ...] = ()


@dataclass(frozen=True)
class Code:
    """The files of this project and of the user that a job runs, and the versions of other packages by name."""

    files: tuple[Path, ...]
    versions: dict[str, str]


def imports_of(file: Path) -> list[str]:
    """Return the dotted names that a file of Python imports, except for relative ones and for those of type checkers."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    return sorted(set(_names_imported(tree)))


Read = Callable[[Path], Iterable[str]]
"""A function as `imports_of`, which may remember what it found."""


def code_of(
    runs: Runs,
    sources: Sequence[Path],
    studies: Sequence[Path] = (),
    plug_ins: Iterable[PlugIn] = (),
    read: Read = imports_of,
) -> Code:
    """Find the code of a job in the folders `sources`, which hold this project's packages.

    Modules that files outside of the library import are also looked for in the folders `studies`. A plug-in counts where
    it registered with a module of the job's places: a file with what it imports, an installed one by its version.
    """
    places = {*ALWAYS, *runs.places}
    plug_ins = [one for one in plug_ins if any(_is_within(home, places) for home in one.registries)]
    own = [*runs.own, *(one.file for one in plug_ins if one.file is not None)]
    files, imported = _outside(own, studies, read)
    own_names = {file.stem for file in files}
    # What the table does not name: with its own row, or with all of the library.
    for module in imported:
        if module.startswith(f"{LIBRARY}.") and not _is_within(module, places):
            places |= {*CODE.get(module.split(".")[1], [LIBRARY])}
    files |= {Path(os.path.relpath(runs.script))}
    others = {module.partition(".")[0] for module in imported}
    for place in places:
        found, packages = _at(place, tuple(sources), read)
        files |= found
        others |= packages
    others -= {"", *sys.stdlib_module_names, *own_names, *_packages(sources), *_packages(studies)}
    installed = {str(one.package): version_of(str(one.package)) for one in plug_ins if one.package}
    versions = {name: version_of(name) for name in others} | installed
    return Code(tuple(sorted(files)), dict(sorted(versions.items())))


def module_of(place: str) -> str:
    """Return the dotted name of the folder or module that an entry of `CODE` names."""
    head = place.partition(".")[0]
    return (
        place if head in {LIBRARY, "contourlets", "visuohaptic_workflow"} else f"{LIBRARY}.{place}"
    )


def _is_within(module: str, places: Iterable[str]) -> bool:
    return any(f"{module}.".startswith(f"{module_of(place)}.") for place in places)


@cache
def _at(
    place: str, sources: tuple[Path, ...], read: Read
) -> tuple[frozenset[Path], frozenset[str]]:
    """Return the files of a folder or module, with data beside them, and the packages that the modules import."""
    module = module_of(place)
    path = next(
        path
        for source in sources
        for path in [source.joinpath(*module.split("."))]
        if path.is_dir() or path.with_suffix(".py").is_file()
    )
    if path.is_dir():
        files = {one for one in path.rglob("*.*") if one.suffix in {".py", ".json", ".parquet"}}
        modules = {one for one in files if one.suffix == ".py"}
    else:
        files = {path.with_suffix(".py")}
        modules = {*files}
        # Which Python runs before it.
        packages = [one / "__init__.py" for one in path.parents if (one / "__init__.py").is_file()]
        files |= {*packages[:-1]}
    found = {name for one in modules for name in read(one)}
    return frozenset(files), frozenset(name.partition(".")[0] for name in found)


def _outside(
    files: Iterable[Path], folders: Sequence[Path], read: Read
) -> tuple[set[Path], set[str]]:
    """Follow imports from files to modules that lie in some folders; give all files, and the names that they import."""
    found: set[Path] = set()
    imported: set[str] = set()
    waiting = list(files)
    while waiting:
        file = Path(os.path.relpath(waiting.pop()))
        if file in found:
            continue
        found.add(file)
        names = set(read(file))
        imported |= names
        if "importlib.resources" in names:
            beside = (file.parent.glob(kind) for kind in ("*.json", "*.parquet", "templates/*.*"))
            found |= {one for some in beside for one in some if one.name not in _OF_REPORT}
        modules = [name for name in names if name.partition(".")[0] not in {"", LIBRARY}]
        waiting += [one for name in modules for one in _modules_at(name, folders)]
    return found, imported


def _modules_at(name: str, folders: Sequence[Path]) -> Iterator[Path]:
    """Return the file of a module and the `__init__` files of its packages, from the first folder that has any."""
    parts = name.split(".")
    for folder in folders:
        paths = [folder.joinpath(*parts[:count]) for count in range(1, len(parts) + 1)]
        files = [file for path in paths for file in (path / "__init__.py", path.with_suffix(".py"))]
        if found := [file for file in files if file.is_file()]:
            yield from found
            return


def _names_imported(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom) and not node.level:
        yield node.module or ""
        yield from (f"{node.module}.{alias.name}" for alias in node.names)
    children: Iterable[ast.AST] = ast.iter_child_nodes(node)
    if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
        children = node.orelse
    for child in children:
        yield from _names_imported(child)


def _packages(sources: Iterable[Path]) -> set[str]:
    return {file.parent.name for source in sources for file in source.glob("*/__init__.py")}


@cache
def version_of(module: str) -> str:
    """Return the version of the package that contains a module, or "none"."""
    for name in _DISTRIBUTIONS.get(module, (module,)):
        try:
            return _version_in_header(name)
        except PackageNotFoundError:
            continue
    return "none"


def _version_in_header(name: str) -> str:
    """Return what `importlib.metadata.version` returns; that function also parses the package's long description."""
    header, _, _ = (distribution(name).read_text("METADATA") or "").partition("\n\n")
    found = re.search(r"^Version: *(\S+)", header, re.MULTILINE)
    return found[1] if found else version(name)
