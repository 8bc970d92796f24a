"""Errors of this package; each message is one sentence that names the allowed values."""


class ContourletError(ValueError):
    """Base of every error that this package raises on purpose."""


class ImageError(ContourletError):
    """The images have a type, a shape or values that the transform is not defined for."""


class FilterError(ContourletError):
    """There is no filter of that name, or the package that has it is not installed."""


class LevelsError(ContourletError):
    """The levels are not valid, or the transform is not defined for images of this size."""


class CoefficientsError(ContourletError):
    """The coefficients do not belong to this transform."""


class ExtensionError(ContourletError):
    """There is no border extension of that name."""
