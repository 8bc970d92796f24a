"""Errors of this package; each message is one sentence that names the allowed values."""


class ContourletError(ValueError):
    """Base class of all errors of this package."""


class ImageError(ContourletError):
    """The type, shape or values of the images are not allowed."""


class FilterError(ContourletError):
    """No filter has this name, or PyWavelets, which has the filter, is not installed."""


class LevelsError(ContourletError):
    """The levels are not valid, or the transform is not defined for images of this size."""


class CoefficientsError(ContourletError):
    """The coefficients do not belong to this transform."""


class ExtensionError(ContourletError):
    """No border extension has this name."""
