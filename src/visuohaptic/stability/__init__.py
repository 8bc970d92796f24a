"""Hard cases with known answers: how large each step's numerical error is, beside its tolerance."""
