"""Fill README.md and draw its picture from the kept accuracies by cue: `make readme` and `make cues`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from filling import fill_page, plain, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from cues.kept import MeasuredCues, Setting, kept_cues
from cues.sentences import SETTINGS, carries_verdicts
from cues.study import CUES, CueName, is_bare
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import with_interval
from visuohaptic.report.figures import Series, draw_intervals
from visuohaptic.report.wording import points

PAGE = Path(__file__).parent / "README.md"
PICTURE = PAGE.with_name("cues.png")
INTERVALS = IntervalParameters()
SHOWN: Mapping[str, Setting] = {
    "the paper's pipeline, pose known, five touches": Setting(
        "new", "none", "full", 5, "paper", "fixation"
    ),
    **SETTINGS,
}
"""The settings of the table."""
DRAWN = {
    "pipeline order_free, pose known": Setting("new", "none", "full", 5, "order_free", "fixation"),
    "pipeline order_free, nothing known of the pose": Setting(
        "new", "none", "none", 5, "order_free", "fixation"
    ),
    "the paper's pipeline, pose known": Setting("new", "none", "full", 5, "paper", "fixation"),
}
"""The settings of the picture."""


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    few, many = kept_cues().values()
    columns: tuple[CueName, ...] = ("pose", "imprint", "all")
    heads = ["by eye fixations", *(CUES[name] for name in columns)]
    heads += [f"imprints add, {one.objects} objects" for one in (many, few)]
    rows = [
        [
            words,
            *(_share(many, setting, name) for name in columns),
            *(_gain(one, setting) for one in (many, few)),
        ]
        for words, setting in SHOWN.items()
        if many.has(setting, "all")
    ]
    sources = "; ".join(
        f"{one.objects} objects: {one.source.commit[:12]}, {one.source.date}"
        for one in (many, few)
        if one.source
    )
    return {
        "headline": "\n\n".join(map(headline, (many, few))),
        "settings": table(heads, rows),
        "sources": wrapped(f"Measured once and kept; {sources}."),
    }


def headline(measured: MeasuredCues) -> str:
    """Return what carries the accuracy on a set of objects."""
    verdicts = plain(carries_verdicts(measured, INTERVALS))
    return wrapped(
        f"On {measured.objects} objects, five touches, pose known: {verdicts[0].lower()}{verdicts[1:]}"
    )


def _share(measured: MeasuredCues, setting: Setting, name: CueName) -> str:
    if measured.has(setting, name):
        return share(measured.accuracy(setting, name, INTERVALS).mean)
    return "nothing to tell" if is_bare(setting.frame, setting.touches) else "not measured"


def _gain(measured: MeasuredCues, setting: Setting) -> str:
    if not measured.has(setting, "all", "pose"):
        return "all of it" if is_bare(setting.frame, setting.touches) else "not measured"
    return plain(with_interval(measured.difference(setting, "all", "pose", INTERVALS), points))


def draw(measured: MeasuredCues) -> Figure:
    """Draw the accuracy by each cue, one mark per pipeline and known part of the pose."""
    series = [
        Series(
            label,
            place,
            [
                measured.accuracy(setting, name, INTERVALS) if measured.has(setting, name) else None
                for name in CUES
            ],
        )
        for place, (label, setting) in enumerate(DRAWN.items())
    ]
    return draw_intervals(list(CUES.values()), "cues of a touch", series)


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(list(kept_cues().values())[-1]), PICTURE)
