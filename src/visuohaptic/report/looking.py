"""What the eye alone recognises, what touch adds to it, and what the next touch is worth."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visuohaptic.errors import ReportError
from visuohaptic.report.comparison import Figure
from visuohaptic.report.wording import counted, percent
from visuohaptic.studies.looking.settings import CHECKED, LOOK, PRODUCT, TOUCH

ANSWERS = {LOOK: "look", TOUCH: "touch", PRODUCT: "product", CHECKED: "checked product"}
"""What is shown, by the names of `tables.LOOKING`."""

Row = Mapping[str, Any]


@dataclass(frozen=True)
class LookingFigures:
    """What the section shows.

    Attributes
    ----------
    sentence : str
        The answer.
    answers : mapping of str to str
        Names of the answers' columns, by their keys in the rows.
    rows : tuple of mapping
        By sight: ``sight``, and of each answer a `Figure`.
    curves : tuple of mapping
        Accuracy and time of the robot: ``answer``, ``strategy``, ``touches``, ``seconds``,
        ``accuracy``.
    """

    sentence: str
    answers: Mapping[str, str]
    rows: tuple[Row, ...]
    curves: tuple[Row, ...]


def looking_figures(path: str | Path | None) -> LookingFigures | None:
    """Read the figures of study looking; None where it was not measured.

    Raises `ReportError` if they can't be read.
    """
    if path is None or not Path(path).is_file():
        return None
    try:
        found = json.loads(Path(path).read_text(encoding="utf-8"))
        rows = tuple(_row(one) for one in found["sights"])
        return LookingFigures(_sentence(found, rows), ANSWERS, rows, tuple(found["curves"]))
    except (OSError, ValueError, TypeError, LookupError) as error:
        raise ReportError(
            f"{path} holds no figures of looking ({error}); run `snakemake -j2 looking_all` again."
        ) from error


def _row(one: Row) -> Row:
    cells = {answer: one["answers"][answer] for answer in ANSWERS}
    figures = {
        answer: Figure(*(cell[end] for end in ("accuracy", "low", "high")))
        for answer, cell in cells.items()
    }
    return {"sight": one["sight"], **figures}


def _sentence(found: Row, rows: tuple[Row, ...]) -> str:
    """Say what looking, touching and both reach in clean sight, and in the poorest."""
    clean, poorest = rows[0], min(rows, key=lambda row: row[LOOK].mean)
    price, touches = found["prices"], found["touches"]
    seconds = price["look_seconds"] + touches * price["touch_seconds"]
    return (
        f"A look of {price['look_seconds']:g} s classifies {percent(clean[LOOK].mean)} of the views "
        f"correctly, {counted(touches, 'touch')} in {seconds:g} s {percent(clean[TOUCH].mean)}, both "
        f"together {percent(clean[CHECKED].mean)}; in the poorest sight ({poorest['sight']}) the eye "
        f"alone reaches {percent(poorest[LOOK].mean)}, and both, where views unlike those of training "
        f"are left out, {percent(poorest[CHECKED].mean)}."
    )
