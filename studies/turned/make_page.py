"""Fill README.md and draw its picture from the kept accuracies: `make readme` and `make turned`."""

from __future__ import annotations

from pathlib import Path

from filling import (
    SETS,
    estimated,
    fill_page,
    legend_beside,
    measured,
    plain,
    resized,
    save_picture,
    share,
    table,
    wrapped,
)
from matplotlib.figure import Figure

from turned.kept import HEADLINE_TOUCHES, KNOWN, TurnedSet, read_turned
from turned.leads import LARGEST_SET
from turned.rows import (
    FRAMES_OF_POSES,
    CellName,
    contrast,
    curve_rows,
    frame_rows,
    turned_rows,
)
from turned.study import TRAINED_UPRIGHT, Known
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import with_interval
from visuohaptic.report.figures import Series, draw_by_touches
from visuohaptic.report.wording import POSES, points

PAGE = Path(__file__).parent / "README.md"
PICTURE = PAGE.with_name("turned.png")
INTERVALS = IntervalParameters()
SHOWN: tuple[tuple[Turns, Known], ...] = (
    ("none", "full"),
    ("vertical", "full"),
    ("vertical", "vertical"),
    ("any", "full"),
    ("any", "centre"),
    ("any", "none"),
    ("any", TRAINED_UPRIGHT),
)
"""Turns and known part of the frame of the rows of the table."""


def compared() -> dict[str, tuple[CellName, CellName]]:
    """Return the pairs of cells by fixation to compare: the first minus the second, by label."""

    def cell(turns: Turns, known: Known, touches: int = HEADLINE_TOUCHES) -> CellName:
        return CellName(turns, known, touches, "fixation")

    ours = cell("any", "none")
    return {
        "all assumed, fitted on turned objects": (ours, cell("any", "full")),
        "all assumed, fitted on upright objects": (ours, cell("any", TRAINED_UPRIGHT)),
        "all known of upright objects, 5 touches": (ours, cell("none", "full")),
        "all known of upright objects, 20 touches": (
            cell("any", "none", 20),
            cell("none", "full", 20),
        ),
    }


def pose_sentence() -> str:
    """Return how far the accuracy of the paper's pipeline by fixation falls from pose to pose, by set of objects."""
    kept, said = read_turned(), []
    for name in sorted(kept, key="paper".__eq__):
        upright, *turned = (
            f"{share(row.fixation.mean)} ({POSES[row.turns]})"
            for row in turned_rows(kept[name], INTERVALS)
            if row.pipeline == "paper"
        )
        said.append(f"from {upright} to {' and '.join(turned)} on {SETS[name]}")
    return f"In the paper's pipeline accuracy falls {', and '.join(said)}."


def frame_table(many: TurnedSet, few: TurnedSet) -> str:
    """Return the accuracies of pipeline `order_free`, one row per pose and known part of the frame."""
    rows, fewer = (
        {(row.turns, row.known): row for row in frame_rows(kept, INTERVALS)} for kept in (many, few)
    )
    count, less = (next(iter(one.values())).objects for one in (rows, fewer))
    heads = ["objects are", "known of the frame", f"{count} objects", f"{less} objects"]
    return table(
        heads,
        [
            [
                POSES[turns],
                KNOWN[known].partition(", fitted")[0],
                estimated(row.fixation),
                share(fewer[turns, known].fixation.mean),
            ]
            for turns, known in SHOWN
            for row in [rows[turns, known]]
        ],
    )


def compared_sentence(many: TurnedSet) -> str:
    """Return the gains of descriptors that know nothing of the pose over descriptors that know or assume the pose."""
    gains = (
        f"{plain(with_interval(contrast(many, [first], [second], INTERVALS), points))} over {label}"
        for label, (first, second) in compared().items()
    )
    return (
        f"For objects turned in any way and nothing known of the pose, in pairs over the {many.held_out.sum()} objects (with "
        f"20 touches, on both sides, over those with so many in reach), in points: {'; '.join(gains)}."
    )


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    kept = read_turned()
    many, few = kept[LARGEST_SET], kept["paper"]
    return {
        "turned": wrapped(pose_sentence()),
        "frames": frame_table(many, few),
        "compared": wrapped(compared_sentence(many)),
        "sources": measured(PAGE.parent),
    }


def draw(kept: TurnedSet) -> Figure:
    """Draw the accuracy by fixation against the number of touches, by pose and known part of the frame."""
    rows = {(row.turns, row.known, row.touches): row for row in curve_rows(kept, INTERVALS)}
    touches = sorted({number for *_, number in rows})
    shown = (*FRAMES_OF_POSES, ("any", "full"))
    series = [
        Series(
            f"{POSES[turns]}; known: {KNOWN[known]}",
            place,
            [rows[turns, known, number].fixation for number in touches],
        )
        for place, (turns, known) in enumerate(shown)
    ]
    return resized(legend_beside(draw_by_touches(touches, series)), 340)


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(read_turned()[LARGEST_SET]), PICTURE)
