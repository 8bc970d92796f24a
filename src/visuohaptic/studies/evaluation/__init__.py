"""Evaluate fitted models on objects that they were not trained on."""
