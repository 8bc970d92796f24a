"""Look at a 3D object, touch it where the eye would rest, and name it from touch alone."""

__version__ = "0.1.0"
