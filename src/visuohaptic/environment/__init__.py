"""The environment ``visuohaptic/Touch-v0`` of Gymnasium: look at an object, choose touches, and predict its class.

Importing this package registers the environment if Gymnasium is installed. The stub `__init__.pyi` lists the names.
"""

from __future__ import annotations

from typing import Any

import lazy_loader

from visuohaptic.base.optional_packages import missing_packages, require

_attribute, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

if missing_packages("environment", "gymnasium") is None:
    from visuohaptic.environment.registration import register

    register()


def __getattr__(name: str) -> Any:
    """Return a public name; raise `MissingPackageError` without Gymnasium."""
    if name in __all__:
        require("environment", "gymnasium")
    return _attribute(name)
