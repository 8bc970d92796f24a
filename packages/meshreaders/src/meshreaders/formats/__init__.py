"""Readers of model files, one group of modules per format."""
