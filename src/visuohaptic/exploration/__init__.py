"""One object from its mesh file to its name, without the workflow."""
