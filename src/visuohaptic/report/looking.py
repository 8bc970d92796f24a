"""What the eye alone recognises, what touch adds to it, and what the next touch is worth."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from visuohaptic.errors import ReportError
from visuohaptic.report.estimates import Row, figure_of
from visuohaptic.report.wording import counted, percent
from visuohaptic.studies.looking.settings import CHECKED, LOOK, PRODUCT, TOUCH

ANSWERS = {LOOK: "look", TOUCH: "touch", PRODUCT: "product", CHECKED: "checked product"}
"""What is shown, by the names of `tables.LOOKING`."""


@dataclass(frozen=True)
class LookingFigures:
    """The answer, a row a sight with a `Figure` of each answer, and the curves of ``reports/looking.json``."""

    sentence: str
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
        return LookingFigures(_sentence(found, rows), rows, tuple(found["curves"]))
    except (OSError, ValueError, TypeError, LookupError) as error:
        raise ReportError(
            f"{path} holds no figures of looking ({error}); run `snakemake -j2 looking_all` again."
        ) from error


def _row(one: Row) -> Row:
    found = {answer: figure_of(one["answers"][answer], "accuracy") for answer in ANSWERS}
    return {"sight": one["sight"], **found}


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
