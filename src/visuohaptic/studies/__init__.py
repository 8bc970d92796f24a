"""Experiments on the method: what each part, effect, touch and second is worth."""
