"""Contourlets for Python: a multiscale, directional decomposition of images, and its inverse.

`Contourlet` is the decimated transform of Do and Vetterli with the numbers of the reference Matlab
toolbox. The package stands on its own: it needs NumPy and PyWavelets.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
