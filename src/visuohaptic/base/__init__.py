"""Modules that every folder may import: array types, errors, seeds, registries, atomic files, optional packages."""
