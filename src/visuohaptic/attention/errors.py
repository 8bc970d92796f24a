"""What the attention model refuses."""


class AttentionError(ValueError):
    """A view, a parameter or a target that the attention model can't take."""
