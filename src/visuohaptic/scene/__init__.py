"""The simulated scene of a touch, and the log of the effects that were simulated."""
