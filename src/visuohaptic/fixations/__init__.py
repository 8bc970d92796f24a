"""Phase `fixations`: from surfaces to views, saliency maps and ordered probing locations."""

import lazy_loader

# Loaded on first use, as in `sensor`. The stub `__init__.pyi` lists the names.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
