"""Fill README.md and draw its picture from the kept accuracies by cue: `make readme` and `make cues`."""

from __future__ import annotations

from pathlib import Path

from filling import fill_page, measured, plain, resized, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from cues.kept import CueSetting, MeasuredCues, kept_cues
from cues.sentences import SETTINGS, carries_verdicts
from cues.study import CUES, CueName, is_bare
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import with_interval
from visuohaptic.report.figures import Series, draw_intervals
from visuohaptic.report.wording import points

PAGE = Path(__file__).parent / "README.md"
PICTURE = PAGE.with_name("cues.png")
INTERVALS = IntervalParameters()
SHOWN = (CueSetting("new", "none", "full", 5, "paper", "fixation"), *SETTINGS.values())
"""The settings of the table."""
DRAWN = {
    "pipeline order_free, pose known": CueSetting(
        "new", "none", "full", 5, "order_free", "fixation"
    ),
    "pipeline order_free, nothing known of the pose": CueSetting(
        "new", "none", "none", 5, "order_free", "fixation"
    ),
    "the paper's pipeline, pose known": CueSetting("new", "none", "full", 5, "paper", "fixation"),
}
"""The settings of the picture."""
_KNOWN = {"full": "known", "none": "unknown"}


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    few, many = kept_cues().values()
    columns: tuple[CueName, ...] = ("pose", "imprint", "all")
    heads = ["pipeline", "objects", "pose", "touches", "no imprint", "imprint", "all"]
    rows = [
        [
            "ours" if setting.pipeline == "order_free" else "paper's",
            setting.tested,
            _KNOWN[setting.frame],
            setting.touches,
            *(_share(many, setting, name) for name in columns),
            _gain(many, setting),
        ]
        for setting in SHOWN
        if many.has(setting, "all")
    ]
    return {
        "headline": headline(many),
        "few": few_sentence(few),
        "settings": table([*heads, "imprints add"], rows),
        "sources": measured(PAGE.parent),
    }


def headline(kept: MeasuredCues) -> str:
    """Return what carries the accuracy on a set of objects."""
    verdicts = plain(carries_verdicts(kept, INTERVALS))
    return wrapped(
        f"On {kept.objects} objects, five touches, pose known: {verdicts[0].lower()}{verdicts[1:]}"
    )


def few_sentence(few: MeasuredCues) -> str:
    """Return in how many settings of the table imprints are shown to add to positions and normals on few objects."""
    gains = [
        few.difference(setting, "all", "pose", INTERVALS)
        for setting in SHOWN
        if few.has(setting, "all", "pose")
    ]
    shown = sum(one.low is not None and one.low > 0 for one in gains)
    return wrapped(
        f"- {few.objects} objects are too few: they show a gain by imprints in {shown} of the {len(gains)} settings of the "
        f"table in which positions and normals tell something.",
        "  ",
    )


def _share(kept: MeasuredCues, setting: CueSetting, name: CueName) -> str:
    if kept.has(setting, name):
        return share(kept.accuracy(setting, name, INTERVALS).mean)
    return "none" if is_bare(setting.frame, setting.touches) else "not measured"


def _gain(kept: MeasuredCues, setting: CueSetting) -> str:
    if not kept.has(setting, "all", "pose"):
        return "all of it" if is_bare(setting.frame, setting.touches) else "not measured"
    return plain(with_interval(kept.difference(setting, "all", "pose", INTERVALS), points))


def draw(kept: MeasuredCues) -> Figure:
    """Draw the accuracy by each cue, one mark per pipeline and known part of the pose."""
    series = [
        Series(
            label,
            place,
            [
                kept.accuracy(setting, name, INTERVALS) if kept.has(setting, name) else None
                for name in CUES
            ],
        )
        for place, (label, setting) in enumerate(DRAWN.items())
    ]
    return resized(draw_intervals(list(CUES.values()), "cues of a touch", series), 370)


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(list(kept_cues().values())[-1]), PICTURE)
