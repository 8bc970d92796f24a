"""Guards of the run: checks that what the report claims is not an error of the code behind it."""
