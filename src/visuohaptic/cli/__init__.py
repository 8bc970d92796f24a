"""The command `visuohaptic`."""

DEBUG = "--debug"
