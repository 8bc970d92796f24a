"""Study `turned`: objects turned about the vertical and in any way."""
