"""Errors of the attention model."""


class AttentionError(ValueError):
    """A view, a parameter or a target is not valid for the attention model."""
