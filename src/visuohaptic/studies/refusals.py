"""Errors that refuse a condition of a study."""

from contourlets.errors import ContourletError
from visuohaptic.attention.errors import AttentionError
from visuohaptic.base.errors import VisuohapticError

REFUSALS = (VisuohapticError, AttentionError, ContourletError)
"""What a condition may fail with; anything else is a fault of the program."""

ERROR = b"error"
"""Metadata of a table of features: the sentence by which they were refused."""
