"""What the accuracy loses when one part is left out or exchanged."""
