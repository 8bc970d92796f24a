"""Baselines of the environment `visuohaptic/Touch-v0`: accuracy and loss by touch of agents that do not learn."""
