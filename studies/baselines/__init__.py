"""Baselines beside our pipeline: the nearest object by kernel density, a perceptron, and the paper's pipeline."""
