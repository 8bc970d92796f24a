"""What the command says: results, progress, errors."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TypeVar

import typer

from visuohaptic.errors import VisuohapticError

Item = TypeVar("Item")

WHOLE_LINE = 500
"""Longest error, in characters; an object's own text may be of any length."""


def say(text: str) -> None:
    """Print a line of results, whatever characters a file's name brings into it."""
    encoding = sys.stdout.encoding or "utf-8"
    shown = printable(text).encode(encoding, "backslashreplace").decode(encoding)
    sys.stdout.write(f"{shown}\n")


def say_json(values: object) -> None:
    """Print values for machines, in ASCII, so that no encoding can spoil them."""
    sys.stdout.write(json.dumps(values, indent=2, default=_plain) + "\n")


def show_progress(steps: list[Item], doing: str) -> Iterable[Item]:
    """Go through steps with a bar on standard error; without one where nobody is looking."""
    from tqdm import tqdm

    return tqdm(steps, desc=printable(doing), leave=False, disable=None, file=sys.stderr)


def check_folder(out: Path) -> None:
    """Refuse, before any work, a file where a folder is to be."""
    if out.exists() and not out.is_dir():
        raise typer.BadParameter(
            f"{printable(str(out))} is a file; a folder is needed.", param_hint="--out"
        )


def printable(text: str) -> str:
    """Write out control characters, line breaks among them, that a file's name may hold."""
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode()
        for character in text
    )


def sentence_of(error: Exception) -> str:
    """Give an error as one sentence that names the thing and a way out.

    Parameters
    ----------
    error : Exception
        Any error.

    Returns
    -------
    str
        One line.
    """
    if isinstance(error, VisuohapticError):
        sentence = str(error)
    elif isinstance(error, OSError) and error.filename is not None:
        sentence = f"{error.filename}: {error.strerror}."
    else:
        kind = type(error).__name__
        sentence = f"{kind}: {error}; `visuohaptic --debug ...` shows where it arose."
    line = printable(sentence.strip())
    return line if len(line) <= WHOLE_LINE else f"{line[:WHOLE_LINE]}…"


def _plain(value: object) -> object:
    return str(value) if isinstance(value, Path) else vars(value)
