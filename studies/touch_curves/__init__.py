"""Study `touch_curves`: accuracy against the number of touches by every strategy, including `adaptive`."""
