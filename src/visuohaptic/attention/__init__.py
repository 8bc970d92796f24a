"""A model of visual attention: where the eye rests on an object, and in which order.

It takes arrays and gives arrays, and stands alone: it knows of pixels, points
and normals, but not of meshes, cameras or touch.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
