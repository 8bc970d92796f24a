"""Errors that a caller can handle; each message is one sentence that says what to do."""


class MeshError(Exception):
    """A mesh can't be read, or has no surface."""


class TooLargeError(MeshError):
    """A file has more bytes than `largest_megabytes` allows."""


class MissingPackageError(Exception):
    """A package that a function needs is not installed."""
