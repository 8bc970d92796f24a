"""The virtual tactile sensor: exact geometry, and the physical effects that a scene needs."""

import lazy_loader

# Loaded on first use, so that reading parameters does not import the sensor. The stub `__init__.pyi` lists the names.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
