"""Import only the compiled module of Open3D, with the USB library that its wheel needs and a bare machine lacks.

The package ``open3d`` also imports a web viewer, which takes most of the time of the import and is not used here. A
later ``import open3d`` finds the same compiled module.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
import sys
from importlib.machinery import ExtensionFileLoader, ModuleSpec, PathFinder
from types import ModuleType

from visuohaptic.base.optional_packages import require


def _load_open3d() -> ModuleType:
    require("open3d", "open3d")
    if importlib.util.find_spec("libusb_package") is not None:
        import libusb_package

        ctypes.CDLL(str(libusb_package.get_library_path()), mode=ctypes.RTLD_GLOBAL)
    # In a notebook Open3D would start a web server that nothing here needs.
    os.environ.setdefault("OPEN3D_DISABLE_WEB_VISUALIZER", "true")
    spec = _compiled_open3d()
    if spec is None or not isinstance(spec.loader, ExtensionFileLoader):
        import open3d

        return open3d
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.modules[spec.name] = module
    return module


def _compiled_open3d() -> ModuleSpec | None:
    package = importlib.util.find_spec("open3d")
    if package is None or not package.submodule_search_locations:
        return None
    return PathFinder.find_spec("open3d.pybind", list(package.submodule_search_locations))


open3d = sys.modules.get("open3d.pybind") or _load_open3d()
"""``open3d.pybind``, or the package ``open3d`` if the compiled module is not found in it."""
