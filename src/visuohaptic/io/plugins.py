"""Plug-ins: the user's own strategies, policies, channels, effects, classifiers, maps and descriptors.

A plug-in is Python code that calls `register`. It can be a file that ``plugins`` in ``params.yaml`` names, or a cell of
a notebook. It can also be a module of an installed package, by an entry point of the group ``visuohaptic.io.plugins``.
A plug-in runs with all rights of the user, as any code that the user writes or installs.
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

if TYPE_CHECKING:
    from types import CodeType

GROUP = "visuohaptic.io.plugins"
"""Group of the entry points of installed plug-ins; each entry point names a module."""

ENVIRONMENT_VARIABLE = "VISUOHAPTIC_PLUGINS"
"""Environment variable that tells child processes which plug-ins to load."""

# By import path: a job imports only the registries in which its plug-ins register entries.
_KINDS = {
    "Strategy": ("visuohaptic.fixations.probing", "PLANNED.add"),
    "Policy": ("visuohaptic.active.registry", "STRATEGIES.add"),
    "LearningPolicy": ("visuohaptic.studies.learning_policies", "add_learning_policy"),
    "Channel": ("visuohaptic.attention.parameters", "add_channel"),
    "Effect": ("visuohaptic.sensor.effects", "add_effect"),
    "Descriptor": ("visuohaptic.features.descriptors", "DESCRIPTORS.add"),
    "Map": ("visuohaptic.recognition.maps", "MAPS.add"),
    "Classifier": ("visuohaptic.recognition.classifiers", "CLASSIFIERS.add"),
}
"""Module and function that add an entry of each class."""


@dataclass(frozen=True)
class PlugIn:
    """A plug-in that was loaded.

    Attributes
    ----------
    source : str
        Absolute path of the file, or name of the module.
    registries : frozenset of str
        Modules of the registries in which the plug-in registered entries.
    package : str, optional
        Installed package of the plug-in; None for a file.
    """

    source: str
    registries: frozenset[str]
    package: str | None = None

    @property
    def file(self) -> Path | None:
        """File of the plug-in; None for a module of an installed package."""
        return None if self.package else Path(self.source)


_loaded: dict[str, PlugIn] = {}
_loading_now: list[tuple[str, set[str]]] = []
"""Sources that are being loaded, innermost last, with the modules of their registries so far."""


def register(entry: object) -> None:
    """Register an entry, so that parameters can name it.

    Parameters
    ----------
    entry : Strategy, Policy, LearningPolicy, Channel, Effect, Descriptor, Map or Classifier
        The entry. Its name must be free; registering the same name again from the same file, or in the same
        session, replaces the entry. Parameters that were read before do not allow the name.

    Raises
    ------
    RegistryError
        If the name is taken or has other characters than a to z and _, or the entry is of another class.

    Examples
    --------
    >>> from sklearn.ensemble import ExtraTreesClassifier
    >>> import visuohaptic as vh
    >>> vh.register(vh.Classifier.of("extra_trees", ExtraTreesClassifier(random_state=0)))
    """
    registry, add = _registry_of(entry)
    source, registries = _loading_now[-1] if _loading_now else ("this session", set())
    attrgetter(add)(importlib.import_module(registry))(entry, source)
    registries.add(registry)
    # pydantic caches the schema with the old names, so rebuild it.
    parameters = sys.modules.get("visuohaptic.parameters")
    if parameters is not None and hasattr(parameters, "ExperimentParameters"):
        parameters.ExperimentParameters.model_rebuild(force=True)


def load_files(files: object, folder: str | Path = ".") -> None:
    """Run the files of plug-ins, paths relative to `folder`; a file runs only once per process.

    `files` is the value of ``plugins`` in ``params.yaml``. Raises `PlugInError` if `files` is no list, or a file is
    missing, fails or registers nothing.
    """
    if isinstance(files, str) or not isinstance(files, Sequence):
        raise PlugInError(f"plugins is {files!r}; a list of Python files is needed.")
    for file in files:
        path = os.path.abspath(os.path.join(folder, str(file)))  # noqa: PTH100, PTH118 - does not resolve links
        if path not in _loaded:
            _load_file(path, str(file))


@cache
def load_installed() -> None:
    """Import the plug-ins of installed packages, once per process.

    A child process imports none here: `load_from_environment` has loaded the plug-ins of its parent.
    """
    if ENVIRONMENT_VARIABLE in os.environ:
        return
    for entry in entry_points(group=GROUP):
        if entry.module not in _loaded:
            _import_module(entry.module, entry.dist.name if entry.dist else entry.module)


def loaded() -> tuple[PlugIn, ...]:
    """Return the plug-ins that were loaded in this process, in order."""
    return tuple(_loaded.values())


def load_in_child_processes() -> None:
    """Make child processes load the plug-ins of this process when they import visuohaptic."""
    os.environ.update(child_environment())


def child_environment() -> dict[str, str]:
    """Return the environment variable with which a child process loads the plug-ins of this process."""
    return {ENVIRONMENT_VARIABLE: os.pathsep.join(_loaded)}


def load_from_environment() -> None:
    """Load the plug-ins of the parent process; if one fails, print the error and exit, because no caller exists yet."""
    try:
        for source in filter(None, os.environ[ENVIRONMENT_VARIABLE].split(os.pathsep)):
            if Path(source).is_absolute():
                load_files([source])
            elif source not in _loaded:
                _import_module(source, source)
    except VisuohapticError as error:
        sys.exit(f"error: {error}")


def _registry_of(entry: object) -> tuple[str, str]:
    for kind in type(entry).__mro__:
        if kind.__name__ in _KINDS and kind.__module__.startswith("visuohaptic."):
            return _KINDS[kind.__name__]
    raise PlugInError(
        f"{type(entry).__name__} can't be registered; an entry of {', '.join(_KINDS)} is needed."
    )


@contextmanager
def _loading(source: str, name: str, package: str | None = None) -> Iterator[None]:
    """Record the registries that a plug-in uses, and turn any error into `PlugInError`."""
    registries: set[str] = set()
    _loading_now.append((source, registries))
    try:
        yield
    except VisuohapticError as error:
        raise PlugInError(f"plug-in {name}: {error}") from error
    except Exception as error:
        reason = " ".join(str(error).split())
        raise PlugInError(
            f"plug-in {name} can't be loaded: {type(error).__name__}: {reason}."
        ) from error
    finally:
        _loading_now.pop()
    if not registries:
        raise PlugInError(f"plug-in {name} registers nothing; it must call visuohaptic.register.")
    _loaded[source] = PlugIn(source, frozenset(registries), package)


class _UncachedLoader(SourceFileLoader):
    """Compiles a file at each load: cached bytecode is compared by seconds, and would miss a second edit in a second."""

    def get_code(self, fullname: str) -> CodeType:  # noqa: ARG002 - the import system's hook
        """Compile the current content of the file."""
        return self.source_to_code(self.get_data(self.path), self.path)


def _load_file(path: str, name: str) -> None:
    if not Path(path).is_file():
        raise PlugInError(f"plugins names {name}, which is not there; a Python file is needed.")
    with _loading(path, name):
        module = f"visuohaptic_plug_in_{len(_loaded)}_{Path(path).stem}"
        spec = spec_from_file_location(module, path, loader=_UncachedLoader(module, path))
        if spec is None or spec.loader is None:
            raise ImportError(path)
        # Data classes and pickle look the module up in sys.modules.
        sys.modules[module] = module_from_spec(spec)
        spec.loader.exec_module(sys.modules[module])


def _import_module(module: str, package: str) -> None:
    with _loading(module, module, package):
        importlib.import_module(module)
