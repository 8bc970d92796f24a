"""What the eye alone recognises, what touch adds to it, and what the next touch is worth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from visuohaptic.report.estimates import Row, figure_of, read_json
from visuohaptic.report.wording import counted, percent
from visuohaptic.studies.looking.settings import CHECKED, LOOK, PRODUCT, TOUCH

ANSWERS = {LOOK: "look", TOUCH: "touch", PRODUCT: "product", CHECKED: "checked product"}
"""What is shown, by the names of `tables.LOOKING`."""


def looking_figures(path: Path) -> Row:
    """Read ``reports/looking.json``: its ``curves``, and ``rows``, a sight each with a `Figure` of each answer."""

    def arranged(found: Row) -> Row:
        rows = [
            {"sight": one["sight"]}
            | {answer: figure_of(one["answers"][answer], "accuracy") for answer in ANSWERS}
            for one in found["sights"]
        ]
        return {"sentence": _sentence(found, rows), "rows": rows, "curves": found["curves"]}

    way_out = "run `snakemake -j2 looking_all` again"
    return read_json(path, arranged, "holds no figures of looking", way_out)


def _sentence(found: Row, rows: Sequence[Row]) -> str:
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
