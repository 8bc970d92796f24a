"""Look at a 3D object, touch it where the eye would rest, and recognise it by touch only.

``import visuohaptic as vh; vh.load("mug.obj").touch(viewpoints=16).recognise()``
"""

import importlib
import os

import lazy_loader

__version__ = "0.2.0"

# Names are imported on first use; the stub `__init__.pyi` lists them.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# A parent process sets this variable. Plug-ins must be loaded before the parameters are checked.
if os.environ.get("VISUOHAPTIC_PLUGINS"):
    importlib.import_module("visuohaptic.io.plugins").load_from_environment()
