"""Checks on each object of the run: how large the numerical error is, beside its tolerance."""
