"""Accuracies of predictions, intervals over objects, comparisons of strategies, and the accuracies of the paper."""
