"""The paper under all its readings: what it leaves open, and what each choice does to its results."""
