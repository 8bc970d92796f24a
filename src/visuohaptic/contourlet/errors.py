"""What can be wrong with a call; each message is one sentence that names what is allowed."""


class ContourletError(ValueError):
    """Base of every error that this package raises on purpose."""


class ImageError(ContourletError):
    """The images have a type, a shape or values that the transform is not defined for."""


class FilterError(ContourletError):
    """No filter goes by that name."""


class LevelsError(ContourletError):
    """The levels are malformed, or the image is too small or too odd for them."""


class CoefficientsError(ContourletError):
    """The coefficients do not belong to this transform."""


class ExtensionError(ContourletError):
    """No rule for the borders goes by that name."""
