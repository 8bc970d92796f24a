"""Studies: experiments that change parameters of the run and compare the accuracies."""
