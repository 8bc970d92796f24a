"""Errors that refuse a condition of a study."""

from contourlets.errors import ContourletError
from visuohaptic.attention.errors import AttentionError
from visuohaptic.base.errors import VisuohapticError

REFUSALS = (VisuohapticError, AttentionError, ContourletError)
"""Expected errors of a condition; other errors are bugs."""

ERROR = b"error"
"""Metadata key of the error message in an empty table of features."""

REFUSED_POLICIES = b"refused_policies"
"""Metadata key, in a table of features, of a JSON object with the error message of each policy that has no rows."""
