"""What predictions say: accuracies, their intervals over objects, comparisons, and the paper's figures beside them."""
