"""Compare pipeline `order_free` with baselines: the nearest object by kernel density, a perceptron, the paper's pipeline."""
