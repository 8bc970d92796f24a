"""Fill the tables of README and docs/scaling.md from the last run and benchmarks: `make readme`."""

from __future__ import annotations

import textwrap
from typing import Any

import pandas as pd
from filling import DOCS, fill_page, points, read_json, share, table

from first_touch.summary import Place, lead, read_kept
from learned.compared import count_classes, kept_of_all, leads_of, objects_in_words
from turned.kept import read_turned
from turned.leads import KeptLeads, read_kept_leads
from turned.rows import turned_rows
from visuohaptic.evaluation.intervals import SIGNIFICANCE
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.parameters import CostParameters
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.comparison import pipeline_tables
from visuohaptic.report.estimates import both_intervals, estimate, with_interval
from visuohaptic.report.leads import verdict
from visuohaptic.report.wording import (
    POSES,
    counted,
    listed,
    percent,
    percent_points,
    strategy_name,
)
from visuohaptic.studies.keeping import read_figures

ROOT = DOCS.parent
UNSEEN = "unseen objects"
LABELS = {
    "k_nearest_neighbours": "kNN",
    "support_vector_machine": "SVM",
    "decision_tree": "decision tree",
    "quadratic_discriminant": "quadratic discriminant",
    "naive_bayes": "naïve Bayes",
}
SETTINGS = {
    "skin alone": "5 touches, imprints only",
    "pose alone": "5 touches, positions and normals only",
    "with its map": "5 touches",
    "without the map": "5 touches, without the map",
}
BESIDE = "\N{NO-BREAK SPACE}/\N{NO-BREAK SPACE}"
STRATEGIES = {"fixation": "eye fixations", "random": "random probing"}
RUNS = {
    "cold_run": "cold `snakemake -j2`, meshes to report",
    "no_op": "nothing to do",
    "recognition_change": "after a change of recognition",
    "sensor_change": "after a change of the sensor",
}


def results_table(metrics: dict[str, Any]) -> str:
    """Set the accuracies of the paper's pipeline, of `reports/metrics.json`, beside the published ones, in per cent."""
    rows = [
        [
            words,
            *(
                f"{100 * results[classifier]['accuracy']['mean']:.1f}{BESIDE}{100 * TABLE_1[classifier][strategy]:.2f}"
                for classifier in LABELS
            ),
        ]
        for strategy, words in STRATEGIES.items()
        for results in [metrics["results"]["paper"][strategy]]
    ]
    return table(["here / published, %", *LABELS.values()], rows)


def answers(metrics: dict[str, Any]) -> str:
    """Answer the questions of the experiment, a list item each, from figures of twelve objects and kept figures of 142."""
    kept = read_kept_leads(IntervalParameters())
    if kept is None:
        raise FileNotFoundError("no leads of 142 objects are kept; run `make draws SET=benchmark`.")
    items = {
        "Can an object be recognised by touch?": recognised(metrics, kept),
        "Does it help to see the object first?": seeing(kept),
        "Does it help to touch the most salient places in sight?": salience(kept),
        "Where to put the first touch?": first_touch(),
        "What does it cost?": view_more(),
    }
    lines = [f"- **{question}** {answer}" for question, answer in items.items()]
    return "\n".join(map(_wrapped, lines))


def recognised(metrics: dict[str, Any], leads: KeptLeads) -> str:
    """Return how often five touches are classified correctly: of the run's objects, and of 142, upright and turned."""
    own = pipeline_tables(metrics)
    paper, ours = (
        with_interval(one.headline.accuracy["fixation"], lambda value: f"{100 * value:.1f}", " %")
        for one in own
    )
    (unknown,) = [
        one.first.mean for one in leads.of("salience") if (one.turns, one.known) == ("any", "none")
    ]
    categories = len(own[0].best.class_accuracy["fixation"])
    kept = read_turned()["benchmark"]
    shares = {
        turns: listed(
            [
                percent(row.fixation.mean)
                for row in turned_rows(kept, IntervalParameters())
                if row.turns == turns and row.pipeline != "literal"
            ]
        )
        for turns in POSES
    }
    classes = len(set(kept.classes))
    return (
        f"Yes: five touches name an unseen bottle, car, chair or animal in {paper} of cases by the paper's pipeline and in "
        f"{ours} by ours (`order_free`; guessing: {percent(1 / categories, 0)}; {counted(own[0].objects, 'object')}). On "
        f"[{counted(len(kept.objects), 'object')} in {counted(classes, 'class')}](docs/meshes.md) the pipelines are right in "
        f"{shares['none']} if objects stand upright and face one way, mostly by "
        f"[where the arm is](studies/cues/README.md), and in {shares['any']} if they are turned in any way "
        f"({percent(unknown)} by features that use no pose; guessing: {percent(1 / classes, 0)})."
    )


def seeing(kept: KeptLeads) -> str:
    """Return the largest lead and the largest deficit of places that are seen over random places in reach."""
    found, drawn = (verdict(kept.of("seeing"), over) for over in ("objects", "classes"))
    if not found.ahead or not found.behind:
        raise ValueError("the answer to `seeing` has another form today: write its sentence again.")
    most = max(found.ahead, key=lambda lead: lead.difference.mean)
    least = min(found.behind, key=lambda lead: lead.difference.mean)
    upright = [lead for lead in found.leads if lead.turns != "any"]
    turned = [lead for lead in found.leads if lead.turns == "any"]
    if any(lead.turns == "any" for lead in found.ahead) or any(
        lead.turns != "any" for lead in found.behind
    ):
        raise ValueError("the answer to `seeing` has another form today: write its sentence again.")
    return (
        f"It can, if objects stand upright: places in sight (fixations, or random ones) led random places in the sensor's "
        f"reach, in sight or not, in {len(found.ahead)} of {counted(len(upright), 'comparison')}, by up to {points(most.difference.mean)} points. On "
        f"objects turned in any way they trailed in {len(found.behind)} of {len(turned)}, by up to "
        f"{points(least.difference.mean)}. For other classes they led in {len(drawn.ahead)} of all "
        f"{len(found.leads)} and trailed in {len(drawn.behind)} (all after Holm's correction)."
    )


def salience(kept: KeptLeads) -> str:
    """Return the lead of fixations over random places in sight that is excluded, for new objects and for new classes."""
    found, drawn = (verdict(kept.of("salience"), over) for over in ("objects", "classes"))
    if found.word != "no" or drawn.excluded is None:
        raise ValueError("the answer to `salience` is not no today: write its sentence again.")
    rows, others = kept_of_all()
    shared = rows["object"].nunique() - others["object"].nunique()
    wide = verdict(lead for lead in leads_of(rows) if lead.name == "salience")
    if wide.ahead:
        raise ValueError(
            "the answer to `salience` has another form today: write its sentence again."
        )
    return (
        f"Not on objects of these classes: fixations led random places in sight in none of "
        f"{counted(len(found.leads), 'comparison')} and trailed in {len(found.behind)}, after Holm's correction; leads above "
        f"{percent_points(found.excluded)} points are excluded, for other classes leads above {percent_points(drawn.excluded)}. "
        f"On {objects_in_words(wide.leads)} upright objects of {count_classes(rows)} classes, {shared} of them in the 142, they led in none "
        f"of {len(wide.leads)} and trailed in {len(wide.behind)}."
    )


def view_more() -> str:
    """Return what one more view costs a robot, and what it gains, on the 142 objects."""
    figures, _ = read_figures(DOCS.parent / "studies/views", "benchmark")
    (ours,) = figures["order_free"]["fixation"].values()
    (paper,) = figures["paper"]["fixation"].values()
    gain, other = (by_views["2 views"] for by_views in (ours, paper))
    if gain["difference_low"] <= 0 or other["difference_low"] > 0 or other["difference_high"] < 0:
        raise ValueError("the answer on views has another form today: write its sentence again.")
    prices = CostParameters()
    seconds = prices.look_seconds + 5 * prices.touch_seconds
    return (
        f"A view with five touches takes a robot {seconds:.1f} s, if a touch takes {prices.touch_seconds:.0f} s. On the 142 "
        f"objects a second view with five more touches gains {points(gain['difference'])} points in our pipeline, while no gain "
        f"is shown in the paper's "
        f"([accuracy and time](docs/accuracy_and_time.md))."
    )


def first_touch() -> str:
    """Return the lead of the first touch at a place where people are predicted to look, in pipeline `order_free`."""
    rows, one = read_kept("benchmark"), Place(touches=1)
    gaze, highest = (
        lead(rows, "human", rival, one, IntervalParameters())
        for rival in ("random_visible", "highest")
    )
    channels, place, shape = (
        lead(rows, part, "random_visible", one, IntervalParameters())
        for part in ("gaze_channels", "gaze_place", "gaze_shape")
    )
    two, front = (
        lead(rows, "human", "random_visible", place, IntervalParameters())
        for place in (Place(touches=2), Place(known="vertical"))
    )
    ends = both_intervals(estimate(gaze.difference, gaze.difference_new_classes), points)
    are_shown = [compared.p_value < SIGNIFICANCE for compared in (gaze, place, shape)]
    if (
        not all(are_shown)
        or min(one.p_value for one in (highest, channels, two, front)) < SIGNIFICANCE
    ):
        raise ValueError(
            "the answer on the first touch has another form today: write its sentence again."
        )
    return (
        f"On an upright object that faces a known way, where a model of human gaze predicts that people look: "
        f"{points(gaze.difference.mean)} points over a random place in sight in our pipeline "
        f"{ends}, by the model's terms for place and shape, not by saliency ([first touch](studies/first_touch/README.md)). The "
        f"highest visible place is not shown to be worse than the predicted place. With two touches, or with an unknown front, no lead over a random place is shown."
    )


def _wrapped(text: str) -> str:
    """Wrap a paragraph or list item; a line that began with a per cent sign would be a comment on the site."""
    indent = "  " if text.startswith("- ") else ""
    lines = textwrap.fill(text, 100, break_on_hyphens=False, subsequent_indent=indent)
    return lines.replace("\N{NO-BREAK SPACE}", " ")


def cost_table(frontier: pd.DataFrame, cost: CostParameters) -> str:
    """Set accuracy beside time, in a row per setting of study `frontier`; computing times are relative to the run's own."""
    of_run = (
        frontier["family"].eq("fixation") & frontier["touches"].eq(5) & frontier["viewpoints"].eq(1)
    )
    (whole,) = frontier.loc[of_run, "seconds"]
    heads = ["pipeline", "places of touch", "touches", "correctly classified", "computing time"]
    rows = [
        [
            "ours" if row.pipeline == "order_free" else "the paper's",
            strategy_name(row.strategy),
            SETTINGS.get(row.setting, row.setting.removesuffix(", 1 viewpoint"))
            + ", imprints of 16 × 16" * (row.family == "small_imprint"),
            f"{share(1 - row.error)} ({100 * (1 - row.error_high):.1f}–{100 * (1 - row.error_low):.1f})",
            f"{100 * row.seconds / whole:.0f} %",
            f"{row.touches * cost.touch_seconds + row.looks * cost.look_seconds:.1f} s",
        ]
        for row in frontier.itertuples()
    ]
    return table([*heads, "a robot's time"], rows)


def speed_table(results: dict[str, Any]) -> str:
    """Set the workflow's seconds, of `benchmarks/results.json`, in a table, the machine named in a sentence."""
    workflow, machine = results["workflow"], results["machine"]
    alone = workflow["paper_pipeline"]
    rows = []
    for name, label in RUNS.items():
        paper = f"{alone[f'{name}_s']:.1f} s" if f"{name}_s" in alone else ""
        spent = f"{workflow[f'{name}_cpu_s']:.1f} s"
        rows.append([label, f"{workflow[f'{name}_s']:.1f} s", spent, paper])
    sentence = (
        f"On {machine['processor']}, {machine['cores']} cores, load {workflow['load_before']} before, "
        f"with bytecode; {workflow['jobs']} jobs in a cold run. `make bench` measures again."
    )
    measured = table(["run", "both pipelines", "processor time", "the paper's only"], rows)
    return f"{measured}\n\n{textwrap.fill(sentence, 100, break_on_hyphens=False)}"


if __name__ == "__main__":
    found = read_json(ROOT / "reports" / "metrics.json")
    blocks = {
        "answers": answers(found),
        "results": results_table(found),
    }
    fill_page(ROOT / "README.md", blocks)
    costs = pd.read_parquet(ROOT / "results" / "frontier.parquet")
    fill_page(DOCS / "accuracy_and_time.md", {"costs": cost_table(costs, CostParameters())})
    timed = read_json(ROOT / "benchmarks" / "results.json")
    fill_page(DOCS / "scaling.md", {"speed": speed_table(timed)})
