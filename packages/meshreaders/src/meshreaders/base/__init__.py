"""Modules that import nothing else of this package: arrays, errors, files, light, images and the mesh itself."""
