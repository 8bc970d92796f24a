"""Cells of CSV files that spreadsheets show as text."""

from __future__ import annotations

from contextlib import suppress

_BEGINNINGS = ("=", "+", "-", "@", "\t", "\r")


def is_formula(text: str) -> bool:
    """Return whether a spreadsheet runs a cell as a formula: text that begins with = + - @, tab or CR, except numbers with blanks between."""
    if not text.startswith(_BEGINNINGS):
        return False
    with suppress(ValueError):
        return not [float(word) for word in text.split()]
    return True


def csv_cell(value: object) -> object:
    """Return a value for a CSV cell: text that a spreadsheet would run as a formula gets an apostrophe before it."""
    return f"'{value}" if isinstance(value, str) and is_formula(value) else value
