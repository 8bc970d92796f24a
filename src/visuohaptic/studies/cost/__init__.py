"""Error rate against run time of several settings, and their Pareto front."""
