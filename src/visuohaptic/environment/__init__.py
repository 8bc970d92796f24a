"""The environment ``visuohaptic/Touch-v0`` of Gymnasium: look at an object, choose touches, and predict its class.

Importing this package does not import Gymnasium; using a name of it does. The stub `__init__.pyi` lists the names.
"""

from __future__ import annotations

from typing import Any

import lazy_loader

from visuohaptic.base.optional_packages import require

_attribute, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Return a public name; raise `MissingPackageError` without Gymnasium."""
    if name in __all__:
        require("environment", "gymnasium")
    return _attribute(name)
