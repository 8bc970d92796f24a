"""A model of visual attention: saliency maps and ordered fixations on views of objects.

It takes arrays of pixels, points and normals and gives arrays; it handles no meshes, cameras or
touch, and uses nothing of the rest of the project.
"""

import lazy_loader

# Parameters are read without OpenCV, which computes the channels; the names are in the stub beside this file.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
