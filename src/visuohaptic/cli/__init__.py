"""The command `visuohaptic`."""
