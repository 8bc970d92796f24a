"""Describe objects and exceptions of the caller in one line, for errors."""

from __future__ import annotations

from typing import Any


def short(thing: Any) -> str:
    """Return the repr of an object in one line of at most 101 characters; its type if the repr fails."""
    try:
        text = " ".join(repr(thing).split())
    except Exception:  # noqa: BLE001 - the repr of any class may raise any exception
        return f"An object of type {type(thing).__name__}"
    return text if len(text) <= 100 else f"{text[:100]}…"


def reason_of(error: BaseException) -> str:
    """Return the message of an exception in one line without a full stop; the type's name if there is no message."""
    return (" ".join(str(error).split()) or type(error).__name__).rstrip(".")
