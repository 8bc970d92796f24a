"""Sentences on what carries the accuracy: positions and normals of touches, or imprints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cues.kept import CueSetting, MeasuredCues
from cues.study import CUES, CueName, Tested
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Estimate, with_interval
from visuohaptic.report.wording import counted, listed, percent, pipeline_name, points


def carries_sentence(
    measured: MeasuredCues,
    intervals: IntervalParameters,
    touches: int = 5,
    strategy: str = "fixation",
) -> str:
    """Return sentences on what carries the accuracy on upright objects: where the sensor is, or what the skin feels.

    Parameters
    ----------
    measured : MeasuredCues
        The accuracies by cue. Of kept accuracies, the sentences name the set and the date.
    intervals : IntervalParameters
        The confidence of the intervals.
    touches : int
        The number of touches per sequence.
    strategy : str
        The strategy of the touches.

    Returns
    -------
    str
        Accuracies of each pipeline by positions and normals, and by imprints; which of the two is ahead; what
        imprints add. A difference has a sign only if its interval excludes 0. A sentence without figures if
        the number of touches or the strategy was not measured.
    """
    upright = _by_pipeline(measured, "new", "none", touches, strategy)
    if not upright:
        return (
            f"What carries the accuracy was not measured for {counted(touches, 'touch')} by strategy {strategy} "
            f"({_named(measured)})."
        )
    pose, imprint = (
        [with_interval(measured.accuracy(one, cue, intervals), percent) for one in upright]
        for cue in _TWO
    )
    names = [pipeline_name(one.pipeline) for one in upright]
    by = listed([f"{one} by {pipeline}" for one, pipeline in zip(pose, names, strict=True)])
    numbers = (
        f"Positions and normals of {counted(touches, 'touch')}, without any imprint, give {by}; imprints only give "
        f"{listed(imprint)} ({_named(measured)})."
    )
    return f"{numbers} {carries_verdicts(measured, intervals, touches, strategy)}"


def carries_verdicts(
    measured: MeasuredCues,
    intervals: IntervalParameters,
    touches: int = 5,
    strategy: str = "fixation",
) -> str:
    """Return which is ahead on upright objects, positions with normals or imprints, and what imprints add.

    Parameters are those of `carries_sentence`. The text is empty if nothing was measured for them.
    """
    upright = _by_pipeline(measured, "new", "none", touches, strategy)
    names = [pipeline_name(one.pipeline) for one in upright]
    ahead = [measured.difference(one, "pose", "imprint", intervals) for one in upright]
    added = [measured.difference(one, "all", "pose", intervals) for one in upright]
    return f"{_verdicts(names, ahead, _WHICH)} {_verdicts(names, added, _ADDED)}".strip()


def imprints_sentence(measured: MeasuredCues, intervals: IntervalParameters) -> str:
    """Return a sentence on the settings in which imprints raise the accuracy of pipeline `order_free`, by fixation.

    Parameters are those of `carries_sentence`. The settings are an unknown pose, a single touch and known
    objects, as far as they are measured. Each gain is that of all cues over positions and normals. Without a pose a
    single touch has only its imprint; its accuracy is given instead of a gain.
    """
    found = [
        f"{words}: {_gain(measured, setting, intervals)}"
        for words, setting in SETTINGS.items()
        if measured.has(setting, "all")
    ]
    return f"What imprints add to positions and normals in pipeline order_free: {'; '.join(found)} ({_named(measured)})."


_TWO: tuple[CueName, CueName] = ("pose", "imprint")

SETTINGS: Mapping[str, CueSetting] = {
    "pose known, five touches": CueSetting("new", "none", "full", 5, "order_free", "fixation"),
    "pose known, one touch": CueSetting("new", "none", "full", 1, "order_free", "fixation"),
    "nothing known of the pose, five touches": CueSetting(
        "new", "none", "none", 5, "order_free", "fixation"
    ),
    "nothing known of the pose, one touch": CueSetting(
        "new", "none", "none", 1, "order_free", "fixation"
    ),
    "objects turned in any way and nothing known of the pose, five touches": CueSetting(
        "new", "any", "none", 5, "order_free", "fixation"
    ),
    "known objects from new viewpoints, one touch": CueSetting(
        "known", "none", "full", 1, "order_free", "fixation"
    ),
    "known objects from new viewpoints, nothing known of the pose, five touches": CueSetting(
        "known", "none", "none", 5, "order_free", "fixation"
    ),
}
"""The settings of `imprints_sentence`."""

_WHICH = (
    "Where the sensor is and how it stands carries more than what the skin feels",
    "What the skin feels carries more than where the sensor is and how it stands",
    "Which of the two carries more is not settled",
)
_ADDED = (
    "Imprints add to positions and normals",
    "Imprints take from what positions and normals give",
    "That imprints add anything to positions and normals is not shown",
)


def _verdicts(names: Sequence[str], differences: Sequence[Estimate], words: Sequence[str]) -> str:
    """Return one sentence per sign of the differences that occurs, with the pipelines and their differences."""
    signs = [_sign(one) for one in differences]
    sentences = []
    for sign in dict.fromkeys(signs):
        listed_ = listed(
            [
                f"{with_interval(one, points, ' points')} in {name}"
                for name, one, own in zip(names, differences, signs, strict=True)
                if own == sign
            ]
        )
        sentences.append(f"{words[sign]}: {listed_}.")
    return " ".join(sentences)


def _sign(difference: Estimate) -> int:
    """Return 0 if the interval lies above 0, 1 if it lies below 0, and 2 for all others."""
    if difference.low is not None and difference.low > 0:
        return 0
    if difference.high is not None and difference.high < 0:
        return 1
    return 2


def _gain(measured: MeasuredCues, setting: CueSetting, intervals: IntervalParameters) -> str:
    if not measured.has(setting, "pose"):
        only = with_interval(measured.accuracy(setting, "all", intervals), percent)
        return f"{only}, all of it by the imprint"
    gain = measured.difference(setting, "all", "pose", intervals)
    shown = ("", ", a loss", ", not settled")[_sign(gain)]
    return f"{with_interval(gain, points, ' points')}{shown}"


def _by_pipeline(
    measured: MeasuredCues, tested: Tested, turns: Turns, touches: int, strategy: str
) -> list[CueSetting]:
    """Return the settings with the full frame that have all cues, pipeline `order_free` first."""
    named = (tested, turns, "full", touches)
    return sorted(
        (
            one
            for one in measured.settings()
            if one[:4] == named and one.strategy == strategy and measured.has(one, *CUES)
        ),
        key=lambda one: one.pipeline != "order_free",
    )


def _named(measured: MeasuredCues) -> str:
    """Return the objects of the figures, and for kept figures the date."""
    objects = counted(measured.objects, "object")
    if measured.source is None:
        return f"{objects} of this run"
    return f"{objects} of set {measured.source.set}, measured on {measured.source.date}"
