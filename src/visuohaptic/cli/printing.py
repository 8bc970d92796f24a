"""Print results, progress and errors of the command, and check its arguments."""

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

JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON.")]

WHOLE_LINE = 500
"""Largest number of characters of a printed error; longer errors are cut."""


def say(text: str) -> None:
    """Print a line of results; characters that the terminal can't show are escaped."""
    encoding = sys.stdout.encoding or "utf-8"
    escaped = printable(text).encode(encoding, "backslashreplace").decode(encoding)
    sys.stdout.write(f"{escaped}\n")


def say_json(values: object) -> None:
    """Print values as JSON, in ASCII, which every encoding can show."""
    sys.stdout.write(json.dumps(values, indent=2, default=_plain) + "\n")


def say_error(error: Exception) -> None:
    """Print an error as one line."""
    sys.stderr.write(f"error: {sentence_of(error)}\n")


def show_progress(steps: list[Item], doing: str) -> Iterable[Item]:
    """Iterate over steps with a progress bar on standard error, if standard error is a terminal."""
    return tqdm(steps, desc=printable(doing), leave=False, disable=None, file=sys.stderr)


def folder_to_write(name: str) -> Path:
    """Return the path of a folder for results; raise ``BadParameter`` if the folder can't be written."""
    if not name:
        raise typer.BadParameter("the name is empty; a folder is needed.")
    folder = Path(name)
    try:
        existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
        if not existing.is_dir():
            raise typer.BadParameter(f"{printable(str(existing))} is a file; a folder is needed.")
        with tempfile.TemporaryFile(dir=existing):
            return folder
    except OSError as error:
        raise typer.BadParameter(f"{printable(name)} can't be written: {error.strerror}.") from None


def file_to_read(name: str) -> Path:
    """Return the path of a file; raise ``BadParameter`` for an empty name, which would be the working folder."""
    if not name:
        raise typer.BadParameter("the name is empty; a file is needed.")
    return Path(name)


def printable(text: str) -> str:
    """Escape control characters and line breaks, which names of files may contain."""
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode()
        for character in text
    )


def sentence_of(error: Exception) -> str:
    """Return an error as one line."""
    sentence = f"{type(error).__name__}: {error}; `visuohaptic --debug ...` prints the traceback."
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
