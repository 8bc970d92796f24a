"""A model of visual attention: saliency maps and ordered fixations on views of objects.

Input and output are arrays of pixels, points and normals. The package imports nothing from the rest of
the project and knows no meshes, cameras or touches.
"""

import lazy_loader

# Loaded on first use, so that reading parameters does not import OpenCV. The stub `__init__.pyi` lists the names.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
