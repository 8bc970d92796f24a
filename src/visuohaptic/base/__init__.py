"""Modules that every folder may import: types of arrays, errors, seeds, registries, atomic files, optional packages."""
