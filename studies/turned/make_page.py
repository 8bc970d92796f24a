"""Fill README.md and draw its picture from the kept accuracies: `make readme` and `make turned`."""

from __future__ import annotations

from pathlib import Path

from filling import SETS, estimated, fill_page, plain, save_picture, share, table, wrapped
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


def pose_table() -> str:
    """Set accuracies by fixation in a row per pose of the objects, and a column per set and pipeline."""
    kept = read_turned()
    found = {name: turned_rows(kept[name], INTERVALS) for name in sorted(kept, key="paper".__ne__)}
    heads, columns = ["objects are"], []
    for name, rows in found.items():
        for pipeline, label in (("paper", "the paper's pipeline"), ("order_free", "ours")):
            columns.append({row.turns: row.fixation for row in rows if row.pipeline == pipeline})
            heads.append(f"{SETS[name]}, {label}")
    return table(
        heads,
        [
            [pose, *(estimated(one[turns]) if turns in one else "" for one in columns)]
            for turns, pose in POSES.items()
        ],
    )


def frame_table(many: TurnedSet, few: TurnedSet) -> str:
    """Return the accuracies of pipeline `order_free`, one row per pose and known part of the frame."""
    rows, fewer = (
        {(row.turns, row.known): row for row in frame_rows(kept, INTERVALS)} for kept in (many, few)
    )
    count, less = (next(iter(one.values())).objects for one in (rows, fewer))
    heads = ["objects are", "known of the frame", f"fixation, {count} objects"]
    heads += ["random, in reach", "random, in sight", f"fixation, {less} objects"]
    return table(
        heads,
        [
            [
                POSES[turns],
                KNOWN[known],
                estimated(row.fixation),
                *map(share, (row.random.mean, row.visible.mean)),
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
        f"In points with 95 % intervals, for objects turned in any way and nothing known of the pose ({many.held_out.sum()} "
        f"objects, fixation): {'; '.join(gains)}."
    )


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    kept = read_turned()
    many, few = kept[LARGEST_SET], kept["paper"]
    sources = ", ".join(
        f"{SETS[name]}: commit {kept[name].source.commit[:12]}, {kept[name].source.date}"
        for name in SETS
    )
    return {
        "turned": pose_table(),
        "frames": frame_table(many, few),
        "compared": wrapped(compared_sentence(many)),
        "sources": wrapped(f"Measured once and kept; {sources}."),
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
    return draw_by_touches(touches, series)


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(read_turned()[LARGEST_SET]), PICTURE)
