"""Fill README.md and draw its picture from the kept answers: `make readme`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
from filling import fill_page, points, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from packaged_model import strangeness
from packaged_model.measure import CHOSEN, gain_of
from visuohaptic.evaluation.intervals import object_interval
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.drawing import COLOURS, style
from visuohaptic.report.estimates import estimate, with_interval
from visuohaptic.report.wording import listed, percent
from visuohaptic.studies.keeping import kept_file

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
SCORES = HERE / "strangeness.md"
PICTURE = HERE / "packaged_model.png"


def kept_answers() -> pd.DataFrame:
    """Read the kept answers, with a column for right names and one for test classes."""
    answers = pd.read_parquet(kept_file(HERE, "all"))
    return answers.assign(
        right=answers["named"] == answers["class"], strange=answers["class"].isin(TEST_CLASSES)
    )


def chosen() -> dict[str, object]:
    """Read what the rule chose, with processor seconds and bytes of both models."""
    return dict(json.loads(CHOSEN.read_text(encoding="utf-8")))


def sentence(answers: pd.DataFrame) -> str:
    """Return the answer of the page: how often the model of the package is right."""
    own = answers[answers["pipeline"] == chosen()["chosen"]]
    known, strange = own[~own["strange"]], own[own["strange"]]
    named = accuracy(known["right"])
    views = accuracy(known["views"])
    covered = [
        name in candidates
        for name, candidates in zip(known["class"], known["candidates"], strict=True)
    ]
    size = np.mean([len(one) for one in known["candidates"]])
    gain = with_interval(estimate(gain_of(answers).difference), points)
    text = (
        f"**The package's model knows {known['class'].nunique()} classes and names {named} of objects that it did not learn "
        f"right from 16 views, and {views} from one view.** Its set of 90 % holds the class of "
        f"{share(float(np.mean(covered)))} of them and has {size:.1f} classes on average. Of {strange['object'].nunique()} objects "
        f"of other classes it calls {share(strange['unknown'].mean(), 0)} unknown, and by mistake "
        f"{share(known['unknown'].mean(), 0)} of objects of known classes. Less than half of the objects of these classes are "
        f"named right: {weak_classes(known)}. By the rule the pipeline is `{chosen()['chosen']}`: `learned` minus `order_free` is "
        f"{gain} points."
    )
    return wrapped(text)


def accuracy(values: pd.Series) -> str:
    """Write a mean over objects with its interval for new objects."""
    numbers = values.to_numpy(np.float64)
    figure = estimate(object_interval(numbers, np.ones(len(numbers)), IntervalParameters()))
    return with_interval(figure, percent)


def weak_classes(known: pd.DataFrame) -> str:
    """List the classes with less than half of the objects named right, as ``stool (1 of 6)``."""
    right = known.groupby("class")["right"].agg(["sum", "count"])
    weak = right[right["sum"] < right["count"] / 2]
    return listed([f"{name} ({row['sum']} of {row['count']})" for name, row in weak.iterrows()])


def blocks() -> dict[str, str]:
    """Return the sentence of the page by name of the block."""
    answers = kept_answers()
    return {"sentence": sentence(answers)}


def blocks_of_scores() -> dict[str, str]:
    """Return the answer and the table of the page on scores of unknown objects."""
    found = json.loads(strangeness.CHOSEN.read_text(encoding="utf-8"))
    areas, best, today = found["areas"], found["best"], strangeness.TODAY
    p_value, of_test = found["gain"]["p_value"], found["areas of test classes"]
    gain, again = (found[name]["difference"] for name in ("gain", "gain on test classes"))
    strange, known = found["test classes"], found["known classes"]
    if not found["taken"] or not again["low"] < 0 < again["high"]:
        raise ValueError("the answer on scores has another form today: write its sentence again.")
    text = (
        f"**The best of five other scores is ahead of today's on classes that were left out of training; on the seven test "
        f"classes its lead is not shown.** On left-out classes *{best}* has the largest area, {gain['mean']:.3f} more than "
        f"today's ({gain['low']:.3f} to {gain['high']:.3f}, p {p_value:.2g}, not corrected for the choice), and by "
        f"the rule it is taken in. On the test "
        f"classes its gain is {again['mean']:.3f} (−{-again['low']:.3f} to {again['high']:.3f}). Of their "
        f"{strange['objects']} objects it calls "
        f"{share(strange[best], 0)} unknown, and today's score {share(strange[today], 0)}; of {known['objects']} held-out "
        f"objects of known classes {share(known[best], 0)} and {share(known[today], 0)}. The package's model keeps today's "
        f"score. This departs from the rule, and was decided after the test classes were seen."
    )
    rows = [
        [
            f"{name} (today's)" if name == today else name,
            f"{areas[name]:.3f}",
            f"{of_test[name]:.3f}",
        ]
        for name in sorted(areas, key=areas.__getitem__, reverse=True)
    ]
    return {
        "found": wrapped(text),
        "areas": table(["score", "20 classes, each left out", "seven test classes"], rows),
    }


@style()
def draw(answers: pd.DataFrame) -> Figure:
    """Draw the share of objects that is named right from 16 views, and from one, by class."""
    known = answers[~answers["strange"] & (answers["pipeline"] == chosen()["chosen"])]
    means = known.groupby("class")[["right", "views"]].mean().sort_values("right")
    chart = Figure(figsize=(6.9, 3.4), layout="constrained")
    axes = chart.subplots()
    places = np.arange(len(means))
    axes.hlines(places, 100 * means["views"], 100 * means["right"], color=COLOURS["line"])
    axes.plot(100 * means["right"], places, "o", color=COLOURS["fixation"], label="from 16 views")
    axes.plot(100 * means["views"], places, "s", color=COLOURS["random"], label="from one view")
    axes.set_yticks(places, [name.replace("_", " ") for name in means.index])
    axes.set_xlabel("objects that the model did not learn, named right, %")
    axes.set_ylabel("class")
    axes.set_xlim(0, 102)
    axes.tick_params("y", labelsize=8)
    axes.legend(loc="lower right")
    return chart


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    fill_page(SCORES, blocks_of_scores())
    save_picture(draw(kept_answers()), PICTURE)
