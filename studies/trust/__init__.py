"""Study `trust`: prediction sets at their stated coverage, and objects of classes that a model does not know."""
