"""Fill README.md and draw its picture from the kept answers: `make readme`."""

from __future__ import annotations

import json
import textwrap
from pathlib import Path

import numpy as np
import pandas as pd
from filling import fill_page, points, save_picture, share, table
from matplotlib.figure import Figure as Chart

from packaged_model.measure import CHOSEN, gain_of
from visuohaptic.evaluation.intervals import object_interval
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.drawing import COLOURS, style
from visuohaptic.report.estimates import estimate, with_interval
from visuohaptic.report.wording import percent
from visuohaptic.studies.keeping import kept_file

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
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
        f"{share(known['unknown'].mean(), 0)} of objects of known classes. By the rule the pipeline is "
        f"`{chosen()['chosen']}`: `learned` minus `order_free` is {gain} points."
    )
    return textwrap.fill(text.replace("\\N{NO-BREAK SPACE}", " "), 100, break_on_hyphens=False)


def accuracy(values: pd.Series) -> str:
    """Write a mean over objects with its interval for new objects."""
    numbers = values.to_numpy(np.float64)
    figure = estimate(object_interval(numbers, np.ones(len(numbers)), IntervalParameters()))
    return with_interval(figure, percent)


def class_table(answers: pd.DataFrame) -> str:
    """Return a table with one row per class: objects, and the share that is named right."""
    known = answers[~answers["strange"] & (answers["pipeline"] == chosen()["chosen"])]
    rows = []
    for category, own in known.groupby("class"):
        wrong = own.loc[~own["right"], "named"].value_counts()
        taken = ", ".join(f"{name} {count}" for name, count in wrong.items())
        rows.append(
            [category, len(own), int(own["right"].sum()), share(own["views"].mean(), 0), taken]
        )
    heads = ["class", "objects", "named right from 16 views", "right from one view", "else named"]
    return table(heads, rows)


def blocks() -> dict[str, str]:
    """Return the sentence and the table of the page by name of the block."""
    answers = kept_answers()
    return {"sentence": sentence(answers), "classes": class_table(answers)}


@style()
def draw(answers: pd.DataFrame) -> Chart:
    """Draw the share of objects that is named right from 16 views, and from one, by class."""
    known = answers[~answers["strange"] & (answers["pipeline"] == chosen()["chosen"])]
    means = known.groupby("class")[["right", "views"]].mean().sort_values("right")
    chart = Chart(figsize=(6.4, 5.2), layout="constrained")
    axes = chart.subplots()
    places = np.arange(len(means))
    axes.hlines(places, 100 * means["views"], 100 * means["right"], color=COLOURS["line"])
    axes.plot(100 * means["right"], places, "o", color=COLOURS["fixation"], label="from 16 views")
    axes.plot(100 * means["views"], places, "s", color=COLOURS["random"], label="from one view")
    axes.set_yticks(places, [name.replace("_", " ") for name in means.index])
    axes.set_xlabel("objects that the model did not learn, named right, %")
    axes.set_ylabel("class")
    axes.set_xlim(0, 102)
    axes.legend(loc="lower right")
    return chart


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(kept_answers()), PICTURE)
