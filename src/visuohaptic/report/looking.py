"""What the eye alone recognises, what touch adds to it, and what the next touch is worth."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visuohaptic.errors import ReportError
from visuohaptic.report.charts import LogAxis, Point, PointChart, place_points
from visuohaptic.report.comparison import Figure
from visuohaptic.report.wording import counted, percent, strategy_name
from visuohaptic.studies.looking.settings import CHECKED, LOOK, PRODUCT, TOUCH

ANSWERS = {LOOK: "look", TOUCH: "touch", PRODUCT: "product", CHECKED: "checked product"}
"""What is shown, by the names of `tables.LOOKING`."""

HEIGHT = 260
"""Of the chart, pixels."""

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
    strategies : tuple of str
        In the order of their colours.
    times : PointChart
        Accuracy in clean sight after a look and after each touch that follows, against time.
    """

    sentence: str
    answers: Mapping[str, str]
    rows: tuple[Row, ...]
    strategies: tuple[str, ...]
    times: PointChart


def looking_figures(path: str | Path | None) -> LookingFigures | None:
    """Read the figures of study looking; None where it was not measured.

    Raises `ReportError` if they can't be read.
    """
    if path is None or not Path(path).is_file():
        return None
    try:
        found = json.loads(Path(path).read_text(encoding="utf-8"))
        rows = tuple(_row(one) for one in found["sights"])
        lines = _lines(found["curves"])
        chart = times_chart(lines)
        return LookingFigures(_sentence(found, rows), ANSWERS, rows, tuple(lines), chart)
    except (OSError, ValueError, TypeError, LookupError) as error:
        raise ReportError(
            f"{path} holds no figures of looking ({error}); run `snakemake -j2 looking_all` again."
        ) from error


def times_chart(lines: Mapping[str, Sequence[Row]]) -> PointChart:
    """Place each strategy's accuracy after a look and after each touch against the robot's time."""
    rows = [row for line in lines.values() for row in line]
    across = LogAxis([row["seconds"] for row in rows])

    def x_of(seconds: float) -> float:
        return round(100 * across.share(seconds), 2)

    def y_of(accuracy: float) -> float:
        return round(HEIGHT * (1 - accuracy), 1)

    points = [
        [Point(row["seconds"], row["accuracy"], _label(strategy, row)) for row in lines[strategy]]
        for strategy in lines
    ]
    marks, drawn = place_points(enumerate(points), x_of, y_of)
    return PointChart(
        height=HEIGHT + 44,
        bottom=HEIGHT,
        x_ticks=tuple((x_of(tick), f"{tick:g} s") for tick in across.ticks()),
        y_ticks=tuple((y_of(share), percent(share, 0)) for share in (0.0, 0.25, 0.5, 0.75, 1.0)),
        lines=drawn,
        marks=marks,
    )


def _lines(curves: Sequence[Row]) -> dict[str, list[Row]]:
    """Give by strategy the look and what follows it, in order of time."""
    looks = [row for row in curves if row["answer"] == LOOK]
    both = [row for row in curves if row["answer"] == CHECKED]
    return {
        strategy: [
            *looks,
            *sorted((row for row in both if row["strategy"] == strategy), key=_seconds),
        ]
        for strategy in dict.fromkeys(row["strategy"] for row in both)
    }


def _seconds(row: Row) -> float:
    return float(row["seconds"])


def _label(strategy: str, row: Row) -> str:
    after = counted(row["touches"], "touch") if row["touches"] else "no touch"
    return f"{strategy_name(strategy)}, {after}, {row['seconds']:g} s: {percent(row['accuracy'])}"


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
