"""How far curves over touches go."""

LONGEST_SEQUENCE = 16
"""Touches of the sequences of which curves over touches are made."""
