"""Find the code of a job's key: folders of the library, files of the user and their imports, versions of packages."""

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

from visuohaptic.base.errors import PlugInError, VisuohapticError

if TYPE_CHECKING:
    from visuohaptic.io.plugins import PlugIn

LIBRARY = "visuohaptic"
MOST_BESIDE = 1000
"""The largest number of files in the folder of a plug-in."""
ALWAYS = ("base", "meshreaders.base")
"""Folders that belong to every row of `CODE`. They import no other folder."""

_TABLES = ("tables.phases", "tables.schema")
_BY_OBJECT = ("io.phase_files", "visuohaptic_workflow.phase_jobs", "geometry", *_TABLES)
_FIXATION_CODE = ("fixations", "attention", "scene", *_BY_OBJECT)
_TOUCH_CODE = ("touches", "sensor", *_FIXATION_CODE)
_FEATURE_CODE = ("features", "contourlets", *_BY_OBJECT)
_PHASES = (
    "meshes",
    "meshreaders",
    *_FIXATION_CODE,
    "active",
    *_TOUCH_CODE,
    *_FEATURE_CODE,
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
"""The row of steps of studies without a row of their own: all folders below the report."""

CODE = {
    "downloads": ("meshes", "meshreaders", "geometry"),
    "credits": ("meshes", "geometry"),
    "meshes": ("meshes", "meshreaders", "geometry"),
    "fixations": _FIXATION_CODE,
    "touches": ("active", *_TOUCH_CODE),
    "features": _FEATURE_CODE,
    "recognition": ("recognition", *_TABLES),
    "model": ("recognition", "__init__", *_TABLES),
    "metrics": ("evaluation", "recognition", "tables.studies", *_TABLES),
    "stability_of_object": ("stability", "contourlets", "tables.stability", *_TOUCH_CODE),
    "features_of_study": _MEASURING,
    "block_of_study": _MEASURING,
    "figures_of_study": ("studies.figures", "evaluation", "recognition", "tables.studies", *_TABLES),
    "frontier_seconds": ("studies.cost.seconds", "studies.cost.settings", *_MEASURING),
    "frontier": STEP,
    "effect_influence": ("studies.effects.influence", *_MEASURING),
    "pictures": (
        "pictures.object_pictures", "pictures.models", "pictures.encoding", "pictures.taxels",
        "geometry", "tables",
    ),
    "report": (*STEP, "report", "pictures", "stability", "__init__"),
}  # fmt: skip
"""Folders and modules of the library by rule. An edit of any of their files reruns the rule's jobs.

Names are relative to src/visuohaptic, or names of other packages of this project. A test finds imports of phases and
scripts from folders that their row lacks (`tests/workflow/test_code_of_jobs.py`).
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
"""Distributions of modules with another name; the first that is installed counts."""

_OF_REPORT = {"section.html.jinja"}
"""Files in templates of studies that are sources of the report instead of a study's step."""


@dataclass(frozen=True)
class Runs:
    """The code that a job runs: a script, folders of the library, and modules of studies.

    Attributes
    ----------
    script : Path
        The script.
    places : tuple of str
        Folders and modules of the library, as in `CODE`.
    own : tuple of Path
        Modules outside of the library. Their imports count too.
    """

    script: Path
    places: tuple[str, ...]
    own: tuple[Path, ...] = ()


@dataclass(frozen=True)
class Code:
    """Files of this project and of the user that a job runs, and versions of other packages by name."""

    files: tuple[Path, ...]
    versions: dict[str, str]


class CodeError(VisuohapticError):
    """A file of code can't be read as Python."""


def imports_of(file: Path) -> list[str]:
    """Return the dotted names that a Python file imports, without relative imports and imports for type checkers.

    Raises
    ------
    CodeError
        If the file has an error of syntax.
    """
    try:
        return [*_imports_in(file.read_text(encoding="utf-8"))]
    except (SyntaxError, ValueError) as error:  # ValueError: bytes that are no text, or a null byte
        line = f", line {error.lineno}" if isinstance(error, SyntaxError) and error.lineno else ""
        reason = error.msg if isinstance(error, SyntaxError) else error
        raise CodeError(f"{file}{line} can't be read as Python: {reason}.") from error


@cache
def _imports_in(text: str) -> tuple[str, ...]:
    """Return the names that Python code imports; of equal files one is parsed."""
    return tuple(sorted(set(_names_imported(ast.parse(text)))))


Read = Callable[[Path], Iterable[str]]
"""`imports_of`, or the same with a cache."""


def code_of(
    runs: Runs,
    sources: Sequence[Path],
    studies: Sequence[Path] = (),
    plug_ins: Iterable[PlugIn] = (),
    read: Read = imports_of,
) -> Code:
    """Find the code of a job.

    Parameters
    ----------
    runs : Runs
        The script and modules of the job.
    sources : sequence of Path
        Folders with this project's packages.
    studies : sequence of Path
        Further folders with modules that `runs.own` and plug-ins may import.
    plug_ins : iterable of PlugIn
        Loaded plug-ins. Plug-ins that registered with a module of the job count: files with their imports and the files
        beside them (`files_beside`), installed packages with their version.
    read : Read
        Reads the imports of a file.

    Returns
    -------
    Code
        The files and versions.
    """
    names = {*ALWAYS, *runs.places}
    plug_ins = [*plug_ins]
    in_use = {plug_in.file for plug_in in plug_ins if plug_in.file is not None}
    plug_ins = [
        plug_in
        for plug_in in plug_ins
        if any(_is_within(registry, names) for registry in plug_in.registries)
    ]
    of_job = [plug_in.file for plug_in in plug_ins if plug_in.file is not None]
    folders = [*studies, *dict.fromkeys(file.parent for file in of_job)]
    files, imported = _files_outside([*runs.own, *of_job], folders, read)
    # Another plug-in in use counts where it is registered, or if it is imported.
    beside = {file for plug_in in of_job for file in files_beside(plug_in)}
    files |= {*map(_relative_to_cwd, beside - in_use)}
    own_modules = {file.stem for file in files if file.suffix == ".py"}
    # Imports from the library beyond the job's row: add the row of the imported folder, or else the whole library.
    for module in imported:
        if module.startswith(f"{LIBRARY}.") and not _is_within(module, names):
            names |= {*CODE.get(module.split(".")[1], [LIBRARY])}
    files |= {Path(os.path.relpath(runs.script))}
    packages = {module.partition(".")[0] for module in imported}
    for name in names:
        files_of_name, packages_of_name = _files_in_library(name, tuple(sources), read)
        files |= files_of_name
        packages |= packages_of_name
    packages -= {
        "", *sys.stdlib_module_names, *own_modules, *_packages(sources), *_packages(studies)
    }  # fmt: skip
    packages |= {str(plug_in.package) for plug_in in plug_ins if plug_in.package}
    versions = {package: version_of(package) for package in sorted(packages)}
    return Code(tuple(sorted(files)), versions)


@cache
def files_beside(plug_in: Path) -> tuple[Path, ...]:
    """List all files in the folder of a plug-in and its subfolders, except hidden files and bytecode.

    A plug-in can read any of these files in ways that no import shows, so all of them belong to a job's key.

    Raises
    ------
    PlugInError
        If the folder contains the working folder, which has results, or more than `MOST_BESIDE` files.
    """
    folder = plug_in.parent
    sentence = (
        f"plug-in {plug_in} needs a folder of its own, such as plug_ins/{plug_in.name}, because every file beside a "
        "plug-in decides which jobs run"
    )
    if Path.cwd().is_relative_to(folder):
        raise PlugInError(f"{sentence}; {folder} contains the results.")
    files = []
    for place, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if name != "__pycache__" and name[0] != "."]
        files += [Path(place, name) for name in names if name[0] != "." and name[-4:] != ".pyc"]
        if len(files) > MOST_BESIDE:
            raise PlugInError(f"{sentence}; {folder} has more than {MOST_BESIDE} files.")
    return tuple(sorted(files))


def module_of(name: str) -> str:
    """Return the full dotted name of a folder or module of `CODE`."""
    packages = {LIBRARY, "contourlets", "meshreaders", "visuohaptic_workflow"}
    return name if name.partition(".")[0] in packages else f"{LIBRARY}.{name}"


def _is_within(module: str, names: Iterable[str]) -> bool:
    return any(f"{module}.".startswith(f"{module_of(name)}.") for name in names)


@cache
def _files_in_library(
    name: str, sources: tuple[Path, ...], read: Read
) -> tuple[frozenset[Path], frozenset[str]]:
    """Return the files of a folder or module, with its data files, and the packages that they import."""
    module = module_of(name)
    path = next(
        path
        for source in sources
        for path in [source.joinpath(*module.split("."))]
        if path.is_dir() or path.with_suffix(".py").is_file()
    )
    if path.is_dir():
        files = {file for file in path.rglob("*.*") if file.suffix in {".py", ".json", ".parquet"}}
        modules = {file for file in files if file.suffix == ".py"}
    else:
        files = {path.with_suffix(".py")}
        modules = {*files}
        # Python runs the __init__ files of its packages before a module; that of the outermost does not count.
        packages = [file for folder in path.parents if (file := folder / "__init__.py").is_file()]
        files |= {*packages[:-1]}
    imported = {import_name for module_file in modules for import_name in read(module_file)}
    return frozenset(files), frozenset(import_name.partition(".")[0] for import_name in imported)


def _files_outside(
    files: Iterable[Path], folders: Sequence[Path], read: Read
) -> tuple[set[Path], set[str]]:
    """Follow imports from files to modules in `folders`. Returns all files, and the names that they import."""
    visited: set[Path] = set()
    imported: set[str] = set()
    waiting = list(files)
    while waiting:
        file = _relative_to_cwd(waiting.pop())
        if file in visited:
            continue
        visited.add(file)
        names = set(read(file))
        imported |= names
        if "importlib.resources" in names:
            data = (file.parent.glob(kind) for kind in ("*.json", "*.parquet", "templates/*.*"))
            visited |= {path for paths in data for path in paths if path.name not in _OF_REPORT}
        modules = [name for name in names if name.partition(".")[0] not in {"", LIBRARY}]
        waiting += [path for name in modules for path in _files_of_module(name, folders)]
    return visited, imported


def _relative_to_cwd(file: Path) -> Path:
    return Path(os.path.relpath(file))


def _files_of_module(name: str, folders: Sequence[Path]) -> list[Path]:
    """Return the file of a module and the `__init__` files of its packages, from the first folder that has any."""
    parts = name.split(".")
    for folder in folders:
        paths = [folder.joinpath(*parts[:count]) for count in range(1, len(parts) + 1)]
        files = [file for path in paths for file in (path / "__init__.py", path.with_suffix(".py"))]
        existing = [file for file in files if file.is_file()]
        if existing:
            return existing
    return []


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
    """Return the result of `importlib.metadata.version`, without parsing the package's long description."""
    header, _, _ = (distribution(name).read_text("METADATA") or "").partition("\n\n")
    match = re.search(r"^Version: *(\S+)", header, re.MULTILINE)
    return match[1] if match else version(name)
