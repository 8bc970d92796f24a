"""Accuracy over the number of touches, by every strategy."""
