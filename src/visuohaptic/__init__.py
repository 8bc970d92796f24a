"""Look at a 3D object, touch it where the eye would rest, and recognise it from touch alone.

``import visuohaptic as vh; vh.load("mug.obj").touch(viewpoints=16).recognise()``
"""

import importlib
import os

import lazy_loader

__version__ = "0.2.0"

# What is not used is not imported; the names are in the stub beside this file.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# Set by a process that starts this one: before anything else knows which names there are.
if os.environ.get("VISUOHAPTIC_PLUGINS"):
    importlib.import_module("visuohaptic.io.plugins").load_from_environment()
