"""Study `ablations`: one part of the method left out or exchanged, everything else as in the run."""
