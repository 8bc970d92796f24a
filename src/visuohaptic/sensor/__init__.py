"""The virtual tactile sensor: exact geometry, and the effects that a scene needs."""

import lazy_loader

# Parameters are read without what touches; the names are in the stub beside this file.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
