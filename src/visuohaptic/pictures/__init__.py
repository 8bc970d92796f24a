"""Small pictures, models that a reader turns, and their words, for the report and for explorations."""
