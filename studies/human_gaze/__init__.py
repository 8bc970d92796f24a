"""Compare the attention model with recordings of where people looked on objects."""
