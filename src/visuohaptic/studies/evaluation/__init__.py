"""Fitted models, measured on objects that they have not learnt."""
