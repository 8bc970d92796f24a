"""The simulated scene of a touch, and the log of the effects that were simulated."""

import lazy_loader

# Loaded on first use, as in `sensor`. The stub `__init__.pyi` lists the names.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
