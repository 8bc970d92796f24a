"""What the command says: results, progress, errors."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, TypeVar

import typer
from tqdm import tqdm

from visuohaptic.base.errors import VisuohapticError

Item = TypeVar("Item")

JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON, for machines.")]

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


def say_error(error: Exception) -> None:
    """Print an error as one line."""
    sys.stderr.write(f"error: {sentence_of(error)}\n")


def show_progress(steps: list[Item], doing: str) -> Iterable[Item]:
    """Go through steps with a bar on standard error; without one where nobody is looking."""
    return tqdm(steps, desc=printable(doing), leave=False, disable=None, file=sys.stderr)


def folder_to_write(name: str) -> Path:
    """Take the name of a folder for results; refuse, before any work, one that can't be written."""
    if not name:
        raise typer.BadParameter("the name is empty; a folder is needed.")
    folder = Path(name)
    try:
        there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
        if not there.is_dir():
            raise typer.BadParameter(f"{printable(str(there))} is a file; a folder is needed.")
        with tempfile.TemporaryFile(dir=there):
            return folder
    except OSError as error:
        raise typer.BadParameter(f"{printable(name)} can't be written: {error.strerror}.") from None


def file_to_read(name: str) -> Path:
    """Take the name of a file; an empty one would mean this folder."""
    if not name:
        raise typer.BadParameter("the name is empty; a file is needed.")
    return Path(name)


def printable(text: str) -> str:
    """Write out control characters, line breaks among them, that a file's name may hold."""
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode()
        for character in text
    )


def sentence_of(error: Exception) -> str:
    """Give an error as one line: a sentence that names the thing and a way out."""
    sentence = f"{type(error).__name__}: {error}; `visuohaptic --debug ...` shows where it arose."
    if isinstance(error, VisuohapticError):
        sentence = str(error)
    elif isinstance(error, MemoryError):
        sentence = "There is not enough memory for this."
    elif isinstance(error, OSError) and error.strerror is not None:
        sentence = f"{error.filename or 'Writing or reading failed'}: {error.strerror}."
    line = printable(sentence.strip())
    return line if len(line) <= WHOLE_LINE else f"{line[:WHOLE_LINE]}…"


def _plain(value: object) -> object:
    return str(value) if isinstance(value, Path) else vars(value)
