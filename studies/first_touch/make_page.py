"""Fill README.md and draw its picture from the kept tables: `make readme` and `make first_touch`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from filling import DOCS, fill_page, points, resized, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from first_touch.study import FRAMES, RULES, TOUCHES
from first_touch.summary import LABELS, Place, accuracies, lead, read_kept
from first_touch_turned.study import TURNS
from visuohaptic.attention.registry import CHANNELS
from visuohaptic.evaluation.intervals import SIGNIFICANCE, PairedComparison, holm
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import estimate, with_interval
from visuohaptic.report.figures import Series, draw_leads
from visuohaptic.report.wording import listed

PAGE = Path(__file__).parent / "README.md"
PICTURE = PAGE.with_name("first_touch.png")
SETS = ("benchmark", "paper")
DRAWN = (
    *("human", "highest", "nearest", "central", "fixation", "curvature"),
    *("gaze_channels", "gaze_view", "gaze_place", "gaze_shape"),
)
"""Ways to choose the first touch in the picture."""
SINGLE = {name: f"fixations by channel {name} only" for name in CHANNELS}
"""Fixations by single channels of saliency in words."""
SHOWN = (1, 5)
"""Numbers of touches in the table of leads; p values are corrected for all `TOUCHES`."""
RIVALS = ("random_visible", *RULES)
"""Opponents of strategy `human`."""

_SHORT = {
    "random_visible": "random in sight",
    "highest": "the highest",
    "nearest": "the nearest",
}
"""Opponents of the table; p values are corrected for all `RIVALS`."""
PIPELINES = {"order_free": "our pipeline", "paper": "the paper's pipeline"}
INTERVALS = IntervalParameters()


Leads = Mapping[tuple[Place, str], PairedComparison]
"""Leads of strategy `human` by setting and rival."""

_TURNED: Mapping[Turns, str] = {
    "none": "upright",
    "vertical": "about the vertical",
    "any": "in any way",
}


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    many, few = (read_kept(name) for name in SETS)
    leads = human_leads(many)
    return {
        "sentence benchmark": wrapped(f"{sentence(many)}."),
        "parts": wrapped(part_sentence(many)),
        "turned": wrapped(turned_sentence(leads)),
        "leads": lead_table(leads),
        "few": "\n".join(
            wrapped(text, "  ") for text in (few_sentence(few), *missing_sentences(many, few))
        ),
    }


def human_leads(rows: pd.DataFrame) -> Leads:
    """Compute the lead of strategy `human` over each rival, by measured setting."""
    settings = [
        Place(pipeline, touches, turns, known)
        for turns, frames in FRAMES.items()
        for known in frames
        for pipeline in (PIPELINES if known == "full" else ("order_free",))
        for touches in TOUCHES
    ]
    return {
        (one, rival): lead(rows, "human", rival, one, INTERVALS)
        for one in settings
        if measured(rows, "human", one)
        for rival in RIVALS
    }


def lead_table(leads: Leads) -> str:
    """Return leads of strategy `human`, one row per setting; p values are corrected for all `leads`.

    Turned objects have one row per setting with one touch and the whole pose known.
    """
    written = dict(zip(leads, in_words(list(leads.values())), strict=True))
    heads = ["objects", "pipeline", "touches", *(f"minus {words}" for words in _SHORT.values())]
    shown = [
        one
        for one in dict.fromkeys(one for one, _ in leads)
        if one.known == "full" and one.touches in (SHOWN if one.turns == "none" else (1,))
    ]
    return table(
        heads,
        [
            [
                _TURNED[one.turns],
                "ours" if one.pipeline == "order_free" else "the paper's",
                one.touches,
                *(written[one, rival] for rival in _SHORT),
            ]
            for one in shown
        ],
    )


def turned_sentence(leads: Leads) -> str:
    """Return the leads over random places in sight on turned objects, and how many stand after correction for all `leads`."""
    about, any_way = (
        estimate(leads[Place(turns=turns), "random_visible"].difference_new_classes)
        for turns in TURNS
    )
    adjusted = zip(leads.items(), holm([one.p_value for one in leads.values()]), strict=True)
    turned = [
        int(np.sign(found.difference.mean)) if p < SIGNIFICANCE else 0
        for ((place, rival), found), p in adjusted
        if place.turns != "none" and rival == "random_visible"
    ]
    return (
        f"On turned objects the lead is, for new classes, {with_interval(about, points)} about the vertical and "
        f"{with_interval(any_way, points)} in any way. Of {len(turned)} leads of predicted gaze over random places in "
        f"sight there {turned.count(1)} stand ahead after Holm's correction for all {len(leads)} leads of predicted gaze, and "
        f"{turned.count(-1)} behind."
    )


def few_sentence(rows: pd.DataFrame) -> str:
    """Return how many leads of strategy `human` stand on few objects, in all poses."""
    leads = human_leads(rows).values()
    (objects,) = {one.objects for one in leads}
    stand = sum(p < SIGNIFICANCE for p in holm([found.p_value for found in leads]))
    return f"- On the paper's {objects} objects, upright and turned, {stand} of {len(leads)} such leads stand after correction."


def missing_sentences(many: pd.DataFrame, few: pd.DataFrame) -> Iterator[str]:
    """Yield a sentence on the channels that were measured on few objects only, if there are any."""
    channels = [
        name
        for name in CHANNELS
        if measured(few, "fixation", Place(looking=name))
        and not measured(many, "fixation", Place(looking=name))
    ]
    if channels:
        yield f"- Single channels {listed(channels)} were measured on these objects only."


def first_touch_leads(rows: pd.DataFrame) -> dict[tuple[str, str], PairedComparison]:
    """Compute the lead over random places in sight at the first touch, by pipeline and way to choose the place."""
    looks = [(label, strategy, "default") for strategy, label in LABELS.items()]
    looks += [(label, "fixation", name) for name, label in SINGLE.items()]
    return {
        (pipeline, label): _over_sight(rows, strategy, Place(pipeline, looking=looking))
        for label, strategy, looking in looks
        for pipeline in PIPELINES
        if strategy not in {"random", "random_visible"}
        and measured(rows, strategy, Place(pipeline, looking=looking))
    }


def part_sentence(rows: pd.DataFrame) -> str:
    """Return the ways of the picture that are ahead of random places in sight, and what single channels lead by.

    P values are corrected for all ways.
    """
    leads = first_touch_leads(rows)
    adjusted = holm([one.p_value for one in leads.values()])
    sides = {
        key: int(np.sign(one.difference.mean)) if p < SIGNIFICANCE else 0
        for (key, one), p in zip(leads.items(), adjusted, strict=True)
    }
    ahead, channels = [], []
    for pipeline, words in PIPELINES.items():
        drawn = [
            LABELS[name].replace("predicted gaze", "gaze")
            for name in DRAWN
            if sides[pipeline, LABELS[name]] > 0
        ]
        ahead.append(f"in {words} {', '.join(drawn)}")
        single = [(pipeline, label) for label in SINGLE.values() if (pipeline, label) in leads]
        means = [leads[key].difference.mean for key in single]
        found = [sides[key] for key in single]
        channels.append(
            f"{points(min(means))} to {points(max(means))} points in {words} ({found.count(1)} of {len(found)} ahead, "
            f"{found.count(-1)} behind)"
        )
    return (
        f"After Holm's correction for all {len(leads)} leads over random places in sight, ahead are {'; '.join(ahead)}. "
        f"Single channels of saliency differ by {' and '.join(channels)}."
    )


def draw(rows: pd.DataFrame) -> Figure:
    """Draw the lead over random places in sight at the first touch, one row per way to choose the place."""
    leads = first_touch_leads(rows)
    labels = [LABELS[name] for name in DRAWN]
    series = [
        Series(words, place, [estimate(leads[pipeline, label].difference) for label in labels])
        for place, (pipeline, words) in enumerate(PIPELINES.items())
    ]
    chart = draw_leads(labels, "place of the first touch", series)
    chart.axes[0].set_yticks(range(len(labels)), labels)
    return resized(chart, 310)


def sentence(rows: pd.DataFrame) -> str:
    """Return sentences on the first touch by predicted gaze, upright, the whole pose known, in our pipeline."""
    one, two = Place(touches=1), Place(touches=2)
    right = accuracies(rows, "human", one).mean
    gaze, later = (lead(rows, "human", "random_visible", place, INTERVALS) for place in (one, two))
    highest = lead(rows, "human", "highest", one, INTERVALS)
    channels = lead(rows, "gaze_channels", "random_visible", one, INTERVALS)
    front = lead(rows, "human", "random_visible", Place(known="vertical"), INTERVALS)
    answer = "Yes, on upright objects that face a known way" if _sign(gaze) > 0 else "Not shown"
    beside = {1: "worse", 0: "as well, as far as is shown", -1: "better"}[_sign(highest)]
    saliency = "help" if _sign(channels) > 0 else "do not help"
    gone = "is no longer shown" if _sign(gaze) > 0 else "is not shown either"
    stands = "stands" if _sign(later) > 0 else gone
    turned = "also" if _sign(front) > 0 else "not"
    return (
        f"{answer}. With one touch where people are predicted to look, {share(right)} of the views are right in our pipeline; "
        f"the lead over random places in sight is {_both(gaze)}. The highest visible place, a rule without a model, does "
        f"{beside} (lead over it {_both(highest)}), and the model's channels of saliency by themselves {saliency} "
        f"({_both(channels)}). With two touches the lead {stands} ({_both(later)}); with one touch and an unknown front it "
        f"is {turned} shown ({_both(front)}) ({gaze.objects} objects, measured on {rows.attrs['date']})"
    )


def _sign(compared: PairedComparison) -> int:
    """Return 1 for a lead that is ahead, -1 for a lead that is behind, and 0 if the p value is no smaller than `SIGNIFICANCE`."""
    return int(np.sign(compared.difference.mean)) if compared.p_value < SIGNIFICANCE else 0


def _both(compared: PairedComparison) -> str:
    """Return a lead in points with its intervals for new objects and for new classes."""
    new, drawn = estimate(compared.difference), estimate(compared.difference_new_classes)
    classes = (
        f", new classes {points(drawn.low)} to {points(drawn.high)}"
        if drawn.low is not None and drawn.high is not None
        else ""
    )
    objects = (
        f" (new objects {points(new.low)} to {points(new.high)}{classes})"
        if new.low is not None and new.high is not None
        else ""
    )
    return f"{points(new.mean)} points{objects}"


def measured(rows: pd.DataFrame, strategy: str, place: Place) -> bool:
    """Return whether a strategy was measured in a setting."""
    try:
        accuracies(rows, strategy, place)
    except LookupError:
        return False
    return True


def _over_sight(rows: pd.DataFrame, strategy: str, setting: Place) -> PairedComparison:
    sight = rows[rows["strategy"] == "random_visible"].assign(looking=setting.looking)
    return lead(
        pd.concat([rows[rows["strategy"] == strategy], sight]),
        strategy,
        "random_visible",
        setting,
        INTERVALS,
    )


def in_words(found: list[PairedComparison]) -> list[str]:
    """Return leads with their intervals, in bold if the p value after Holm's correction for all leads is below 0.05."""
    written = []
    for one, p in zip(found, holm([one.p_value for one in found]), strict=True):
        words = with_interval(estimate(one.difference), points)
        written.append(f"**{words}**" if p < SIGNIFICANCE else words)
    return written


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(read_kept("benchmark")), PICTURE)
    said = f"**Does a model of gaze help to choose the first touch?** {sentence(read_kept('benchmark'))}"
    link = " ([first_touch](../studies/first_touch/README.md))"
    fill_page(DOCS / "two_questions.md", {"first touch": wrapped(f"{said}{link}.")})
