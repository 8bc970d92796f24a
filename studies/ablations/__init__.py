"""Study `ablations`: one part of the method is left out or replaced, and the rest is as in the run."""
