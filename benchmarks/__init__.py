"""Timings side by side with peers; not tests."""
