"""Compare pipeline `order_free` with baselines: the nearest object by kernel density, a perceptron, twenty lines, the paper's pipeline."""
