"""All studies of a run: those of the package, and the user's own files."""

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
from visuohaptic.studies.draws import RANDOM_DRAWS
from visuohaptic.studies.effects.accuracy import EFFECTS_STUDY, INFLUENCE
from visuohaptic.studies.own import read_study
from visuohaptic.studies.study import Study

STUDIES = (
    FRONTIER,
    EFFECTS_STUDY,
    INFLUENCE,
    RANDOM_DRAWS,
)
"""The studies of the package."""

PACKAGED = tuple(study.name for study in STUDIES)
"""Their names, which no other study may have."""

REPOSITORY = Path(__file__).parents[3] / "studies"
"""The studies of the clone that this package lies in; there is no such folder beside an installed package."""

_KINDS = ("*.yaml", "*.py", "*/study.py")
_NAME = re.compile(r"[a-z][a-z0-9_]{0,40}")


def find_studies(run: ExperimentParameters, folders: Iterable[str | Path]) -> dict[str, Study]:
    """Return every study by its name, first the package's, then the user's.

    A user's study is a file ``<name>.yaml`` or ``<name>.py`` of a folder, or ``<name>/study.py``
    with more beside it; of two folders the first one's counts, but the name of a later folder's
    ``<name>/study.py`` is taken. Python holds a `Study` named ``STUDY``. Raises `ParameterError`,
    which names the file, if one is not as it should be.
    """
    found = {study.name: study for study in STUDIES}
    for name, path in _files(map(Path, folders)).items():
        if not _NAME.fullmatch(name) or name in PACKAGED:
            raise ParameterError(
                f"{path}: {name!r} is no name of a study; up to 41 small letters, digits and "
                f"underscores are allowed, a letter first, and none of {', '.join(PACKAGED)}."
            )
        found[name] = read_study(path, run) if path.suffix == ".yaml" else load_study(path, name)
    return found


def load_study(path: Path, name: str) -> Study:
    """Run a file of Python, which has all rights of the user, and give its study.

    Its folder is searched for modules after all others. Raises `ParameterError` if the file can't be
    run or holds no study of its name.
    """
    study = getattr(import_file(path, name), "STUDY", None)
    if not isinstance(study, Study) or study.name != name:
        raise ParameterError(f"{path} has no STUDY of name {name!r}; one Study is needed.")
    for step in study.steps:
        if not _is_there(step.work):
            raise ParameterError(
                f"{path}: {step.work!r} of step {step.name} is not there; module:function is needed."
            )
    return study


def import_file(path: Path, study: str) -> ModuleType:
    """Import a file of a study, ``<study>.py`` or one of folder ``<study>/``.

    The folder that holds the study is searched for modules after all others. Raises `ParameterError`
    if the file can't be run, or if another module has its name.
    """
    package = path.name in {"study.py", "section.py"}
    folder = path.parents[1] if package else path.parent
    sys.path += {str(folder)} - {*sys.path}
    try:
        module = import_module(f"{study}.{path.stem}" if package else study)
    except VisuohapticError as error:
        raise ParameterError(f"{path}: {error}") from error
    except Exception as error:
        said = " ".join(str(error).split())
        raise ParameterError(f"{path} can't be run: {type(error).__name__}: {said}.") from error
    if not module.__file__ or not path.samefile(module.__file__):
        raise ParameterError(
            f"{path}: {study!r} is the name of another module; choose another one."
        )
    return module


def section_files(folders: Iterable[str | Path]) -> dict[str, Path]:
    """Find the sections that studies bring to the report, ``<study>/section.py``, by study.

    Of two folders with a study of one name, the first one's counts.
    """
    found: dict[str, Path] = {}
    for folder in map(Path, folders):
        for path in sorted(folder.glob("*/section.py")):
            found.setdefault(path.parent.name, path)
    return {name: found[name] for name in sorted(found)}


def _is_there(work: str) -> bool:
    module, _, function = work.partition(":")
    try:
        return find_spec(module) is not None and bool(function)
    except (ImportError, ValueError):
        return False


def _files(folders: Iterable[Path]) -> dict[str, Path]:
    """Find the files of studies by name; of two folders, the first one's."""
    found: dict[str, Path] = {}
    for folder in folders:
        named: dict[str, Path] = {}
        for one in sorted(one for kind in _KINDS for one in folder.glob(kind)):
            name = one.parent.name if one.name == "study.py" else one.stem
            other = named.setdefault(name, one)
            if other is not one:
                raise ParameterError(f"{other} and {one} are studies of one name; one is allowed.")
        for name in found.keys() & named.keys():
            if named[name].name == "study.py" and not named[name].samefile(found[name]):
                raise ParameterError(
                    f"{found[name]}: {name!r} is the name of study {named[name]}; choose another one."
                )
        found = {**named, **found}
    return {name: found[name] for name in sorted(found) if name != "dvc"}
