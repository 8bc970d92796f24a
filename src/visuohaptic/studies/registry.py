"""Find all studies of a run: the studies of the package and of the user's files."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from visuohaptic.base.errors import ParameterError, VisuohapticError
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.settings import FRONTIER
from visuohaptic.studies.effects.accuracy import EFFECTS_STUDY, INFLUENCE
from visuohaptic.studies.own import read_study
from visuohaptic.studies.random_draws import RANDOM_DRAWS
from visuohaptic.studies.study import OBJECTS_OF_STEP, Study

STUDIES = (
    FRONTIER,
    EFFECTS_STUDY,
    INFLUENCE,
    RANDOM_DRAWS,
)
"""The studies of the package."""

PACKAGED = tuple(study.name for study in STUDIES)
"""Names of the studies of the package, which no other study may have."""

REPOSITORY = Path(__file__).parents[3] / "studies"
"""Folder `studies` of the repository that contains this package. An installed package has no such folder."""

_KINDS = ("*.yaml", "*.py", "*/study.py")
_NAME = re.compile(r"[a-z][a-z0-9_]{0,40}")


def find_studies(
    run: ExperimentParameters, folders: Iterable[str | Path]
) -> tuple[dict[str, Study], dict[str, ParameterError]]:
    """Return all studies by name: first the package's, then the user's; and the error of each other file by name.

    A user's study is a file ``<name>.yaml``, ``<name>.py`` or ``<name>/study.py`` in one of the folders. If two folders
    have a study of the same name, the first folder counts; but a ``<name>/study.py`` of a later folder must not have
    the name of an earlier study. A Python file defines a `Study` named ``STUDY``.

    Parameters
    ----------
    run : ExperimentParameters
        The parameters of the run.
    folders : iterable of paths
        The folders of the user's studies.

    Returns
    -------
    studies : dict of str to Study
        The studies; the user's are sorted by name.
    faults : dict of str to ParameterError
        The error of each file that can't be read or has a name that is not allowed. The message names the file.

    Raises
    ------
    ParameterError
        If two files have the same name.
    """
    studies = {study.name: study for study in STUDIES}
    faults = {}
    for name, path in _study_files(map(Path, folders)).items():
        try:
            _check_name(path, name)
            is_yaml = path.suffix == ".yaml"
            studies[name] = read_study(path, run) if is_yaml else load_study(path, name)
        except ParameterError as error:
            faults[name] = error
    return studies, faults


def _check_name(path: Path, name: str) -> None:
    """Raise `ParameterError` if a file of the user has no name of a study, or the name of a study of the package."""
    if not _NAME.fullmatch(name) or name in PACKAGED:
        raise ParameterError(
            f"{path}: {name!r} is no name of a study; up to 41 lower-case letters, digits and underscores, "
            f"beginning with a letter, are allowed, and none of {', '.join(PACKAGED)}."
        )


def load_study(path: Path, name: str) -> Study:
    """Import a Python file and return its study. The file runs with all rights of the user.

    The file's folder is appended to `sys.path`. Raises `ParameterError` if the file can't be imported, defines no
    study of its name, or has a step with an unknown function or unknown `objects`.
    """
    study = getattr(import_file(path, name), "STUDY", None)
    if not isinstance(study, Study) or study.name != name:
        raise ParameterError(
            f"{path} has no STUDY of name {name!r}; a Study of that name is needed."
        )
    for step in study.steps:
        if not _has_module(step.work):
            raise ParameterError(
                f"{path}: step {step.name}: {step.work!r} is not importable; module:function is needed."
            )
        if step.objects not in OBJECTS_OF_STEP:
            raise ParameterError(
                f"{path}: step {step.name}: objects is {step.objects!r}; one of {', '.join(OBJECTS_OF_STEP)} "
                "is needed."
            )
    return study


def import_file(path: Path, study: str) -> ModuleType:
    """Import a file of a study: ``<study>.py``, ``<study>/study.py`` or ``<study>/section.py``.

    The folder of the study is appended to `sys.path`. Raises `ParameterError` if the file can't be imported, or if
    another module has its name.
    """
    package = path.name in {"study.py", "section.py"}
    folder = path.parents[1] if package else path.parent
    sys.path += {str(folder)} - {*sys.path}
    try:
        module = import_module(f"{study}.{path.stem}" if package else study)
    except VisuohapticError as error:
        raise ParameterError(f"{path}: {error}") from error
    except Exception as error:
        reason = " ".join(str(error).split())
        raise ParameterError(f"{path} can't be run: {type(error).__name__}: {reason}.") from error
    if not module.__file__ or not path.samefile(module.__file__):
        raise ParameterError(
            f"{path}: {study!r} is the name of another module; choose another name."
        )
    return module


def section_files(folders: Iterable[str | Path]) -> dict[str, Path]:
    """Find the report sections of studies, ``<study>/section.py``, by study; earlier folders take precedence."""
    by_study: dict[str, Path] = {}
    for folder in map(Path, folders):
        for path in sorted(folder.glob("*/section.py")):
            by_study.setdefault(path.parent.name, path)
    return dict(sorted(by_study.items()))


def _has_module(work: str) -> bool:
    """Return whether ``module:function`` names a module that can be found."""
    module, _, function = work.partition(":")
    try:
        return find_spec(module) is not None and bool(function)
    except (ImportError, ValueError):
        return False


def _study_files(folders: Iterable[Path]) -> dict[str, Path]:
    """Find the files of studies by name; earlier folders take precedence."""
    by_name: dict[str, Path] = {}
    for folder in folders:
        in_folder = _study_files_in(folder)
        for name in by_name.keys() & in_folder.keys():
            earlier, later = by_name[name], in_folder[name]
            if later.name == "study.py" and not later.samefile(earlier):
                raise ParameterError(
                    f"{earlier}: {name!r} is the name of study {later}; choose another name."
                )
        by_name = {**in_folder, **by_name}
    # dvc.yaml of the folder holds stages of DVC.
    return {name: by_name[name] for name in sorted(by_name) if name != "dvc"}


def _study_files_in(folder: Path) -> dict[str, Path]:
    """Find the files of studies in a folder by name."""
    by_name: dict[str, Path] = {}
    for path in sorted(path for kind in _KINDS for path in folder.glob(kind)):
        name = path.parent.name if path.name == "study.py" else path.stem
        other = by_name.setdefault(name, path)
        if other is not path:
            raise ParameterError(
                f"{other} and {path} are studies of the same name; rename one of them."
            )
    return by_name
