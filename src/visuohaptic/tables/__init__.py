"""The schema of every table, and how tables are checked, written and read."""
