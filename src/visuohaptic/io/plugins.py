"""Plug-ins: strategies, policies, channels, effects, classifiers, maps and descriptors of the user's own.

A plug-in is Python that calls `register`: a file that ``plugins`` in ``params.yaml`` names, a module
of an installed package (entry points of the group ``visuohaptic.io.plugins``), or a cell of a
notebook. It runs with all rights of the user, as any code that the user writes or installs.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.machinery import SourceFileLoader
from importlib.metadata import entry_points
from importlib.util import module_from_spec, spec_from_file_location
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING

from visuohaptic.base.errors import PlugInError, VisuohapticError
from visuohaptic.io.moved import FOLDERS

if TYPE_CHECKING:
    from types import CodeType

GROUP = "visuohaptic.io.plugins"
"""The entry points of installed plug-ins: each names a module."""

GIVEN = "VISUOHAPTIC_PLUGINS"
"""The variable of the environment by which a process hands its plug-ins to those that it starts."""

# By name: a job that loads a plug-in imports the registries that this registers with, and no others.
_KINDS = {
    "Strategy": ("visuohaptic.fixations.probing", "STRATEGIES.add"),
    "Policy": ("visuohaptic.fixations.probing", "STRATEGIES.add"),
    "LearningPolicy": ("visuohaptic.studies.learning_policies", "add_learning_policy"),
    "Channel": ("visuohaptic.attention.parameters", "add_channel"),
    "Effect": ("visuohaptic.sensor.effects", "add_effect"),
    "Descriptor": ("visuohaptic.features.descriptors", "DESCRIPTORS.add"),
    "Map": ("visuohaptic.recognition.maps", "MAPS.add"),
    "Classifier": ("visuohaptic.recognition.classifiers", "CLASSIFIERS.add"),
}
"""What holds the entries of each class, and adds one."""


@dataclass(frozen=True)
class PlugIn:
    """A plug-in that was loaded; `source` is its file, as an absolute path, or its module.

    `homes` are the modules that hold what it registered, `package` the installed one that brings it, if any.
    """

    source: str
    homes: frozenset[str]
    package: str | None = None

    @property
    def file(self) -> Path | None:
        """Its file, if it is no installed module."""
        return None if self.package else Path(self.source)


_loaded: dict[str, PlugIn] = {}
_at_work: list[tuple[str, set[str]]] = []


def register(entry: object) -> None:
    """Add an entry of your own, which parameters can name from then on.

    Parameters
    ----------
    entry : Strategy, Policy, LearningPolicy, Channel, Effect, Descriptor, Map or Classifier
        The entry. Its name must be free; registering it again from the same file, or in the same
        session, replaces it. Parameters that were made before do not know it.

    Raises
    ------
    RegistryError
        If its name is taken or can't be one, or it is of another class.

    Examples
    --------
    >>> from sklearn.ensemble import ExtraTreesClassifier
    >>> import visuohaptic as vh
    >>> vh.register(vh.Classifier.of("extra_trees", ExtraTreesClassifier(random_state=0)))
    """
    home, add = _home_of(entry)
    source, homes = _at_work[-1] if _at_work else ("this session", set())
    attrgetter(add)(importlib.import_module(home))(entry, source)
    homes.add(home)
    # Their schema holds a copy of those that they are made of.
    parameters = sys.modules.get("visuohaptic.parameters")
    if parameters is not None and hasattr(parameters, "ExperimentParameters"):
        parameters.ExperimentParameters.model_rebuild(force=True)


def load_files(files: object, folder: str | Path = ".") -> None:
    """Run the files of plug-ins that ``plugins`` names, below a folder, each once in a process.

    Raises `PlugInError` if they are no list, or one is missing, fails, or registers nothing.
    """
    if isinstance(files, str) or not isinstance(files, Sequence):
        raise PlugInError(f"plugins is {files!r}; a list of files of Python is needed.")
    for file in files:
        path = os.path.abspath(os.path.join(folder, str(file)))  # noqa: PTH100, PTH118 - links stay
        if path not in _loaded:
            _load_file(path, str(file))


@cache
def load_installed() -> None:
    """Import the plug-ins of installed packages, once; a process that was handed its plug-ins has them."""
    for one in () if GIVEN in os.environ else entry_points(group=GROUP):
        if one.module not in _loaded:
            _import_module(one.module, one.dist.name if one.dist else one.module)


def loaded() -> tuple[PlugIn, ...]:
    """Give the plug-ins that were loaded in this process."""
    return tuple(_loaded.values())


def hand_on() -> None:
    """Let the processes that this one starts load the same plug-ins when they import visuohaptic."""
    os.environ[GIVEN] = os.pathsep.join(_loaded)


def load_given() -> None:
    """Load what another process handed on, or end this one with a sentence, as no caller is there yet."""
    try:
        for source in filter(None, os.environ[GIVEN].split(os.pathsep)):
            if Path(source).is_absolute():
                load_files([source])
            elif source not in _loaded:
                _import_module(source, source)
    except VisuohapticError as error:
        sys.exit(f"error: {error}")


def _home_of(entry: object) -> tuple[str, str]:
    for one in type(entry).__mro__:
        if one.__name__ in _KINDS and one.__module__.startswith("visuohaptic."):
            return _KINDS[one.__name__]
    raise PlugInError(
        f"{type(entry).__name__} can't be registered; an entry of {', '.join(_KINDS)} is needed."
    )


@contextmanager
def _loading(source: str, name: str, package: str | None = None) -> Iterator[None]:
    """Note what is registered, and turn whatever fails into one sentence."""
    homes: set[str] = set()
    _at_work.append((source, homes))
    try:
        yield
    except VisuohapticError as error:
        raise PlugInError(f"plug-in {name}: {error}") from error
    except Exception as error:
        said = " ".join(str(error).split())
        raise PlugInError(
            f"plug-in {name} can't be loaded: {type(error).__name__}: {said}."
        ) from error
    finally:
        _at_work.pop()
    if not homes:
        raise PlugInError(f"plug-in {name} registers nothing; it must call visuohaptic.register.")
    _loaded[source] = PlugIn(source, frozenset(homes), package)


class _Unkept(SourceFileLoader):
    """Compiles a file each time: kept bytecode goes by times, and an edit within a second has none."""

    def get_code(self, fullname: str) -> CodeType:  # noqa: ARG002 - the import system's hook
        """Compile what the file holds now."""
        return self.source_to_code(self.get_data(self.path), self.path)


def _load_file(path: str, name: str) -> None:
    if not Path(path).is_file():
        moved = [
            f"; folder {old} is now {new}" for old, new in FOLDERS.items() if name.startswith(old)
        ]
        raise PlugInError(
            f"plugins names {name}, which is not there{''.join(moved)}; a file of Python is needed."
        )
    with _loading(path, name):
        module = f"visuohaptic_plug_in_{len(_loaded)}_{Path(path).stem}"
        spec = spec_from_file_location(module, path, loader=_Unkept(module, path))
        if spec is None or spec.loader is None:
            raise ImportError(path)
        # Data classes and pickles look it up there.
        sys.modules[module] = module_from_spec(spec)
        spec.loader.exec_module(sys.modules[module])


def _import_module(module: str, package: str) -> None:
    with _loading(module, module, package):
        importlib.import_module(module)
