"""Errors that are planted in the library's functions, so that checks have something to find."""

import dataclasses

import numpy as np

GENERATOR = np.random.default_rng(0)


def disturbed(value):
    """Return a result that differs in each call: noise on numbers, and one integer gone."""
    if isinstance(value, np.ndarray):
        return _disturbed_array(value)
    if dataclasses.is_dataclass(value):
        fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        return dataclasses.replace(
            value, **{name: disturbed(each) for name, each in fields.items()}
        )
    if isinstance(value, list | tuple) and value and not isinstance(value[0], str):
        return type(value)(map(disturbed, value))
    return value


def _disturbed_array(array):
    if array.dtype.kind == "f":
        return array + GENERATOR.uniform(0.1, 0.2, array.shape).astype(array.dtype)
    if array.dtype.kind == "i" and array.size:
        return np.where(np.arange(array.size).reshape(array.shape) == 0, -1, array)
    return array


def plant(monkeypatch, module, name):
    """Disturb what a function gives, or the methods of a class that cast rays or invert."""
    original = getattr(module, name)
    if not isinstance(original, type):
        monkeypatch.setattr(module, name, lambda *a, **k: disturbed(original(*a, **k)))
        return
    methods = {
        method: _disturbed_method(getattr(original, method))
        for method in ("first_hits", "inverse")
        if hasattr(original, method)
    }
    monkeypatch.setattr(module, name, type(f"Disturbed{name}", (original,), methods))


def _disturbed_method(method):
    return lambda *arguments, **named: disturbed(method(*arguments, **named))
