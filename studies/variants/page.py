"""Write the page of all variants: sentences, the specification curve, and how much each choice explains.

The curve follows U. Simonsohn, J. Simmons and L. Nelson, "Specification curve analysis", Nature Human Behaviour 4,
2020. Variants are sorted by result, with their options below.

`python -m variants.page FILE` writes the page of the kept variants.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, PackageLoader
from markupsafe import Markup

from variants.choices import BEST_OF_PAPER, BY_NAME, CHOICES
from variants.design import is_default
from variants.kept import OUTSIDE, MeasuredVariants, kept_variants, read_variants
from variants.leads import PairLead, against_main, leads_by_option, strongest_pair, sum_up
from variants.weighing import summarise_variants
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.pictures.page_head import content_policy, page_style
from visuohaptic.report.environment import make_environment
from visuohaptic.report.wording import classifier_name, listed, percent, points, spaced
from visuohaptic.studies.figures import Row
from visuohaptic.studies.study import StepInputs

COMMAND = "snakemake -j2 results/variant/{}.json"
"""Command that measures one variant again."""

WIDTH = 1000
_LEFT = 190
_TOP, _CURVE_HEIGHT = 16, 300
_ROW, _GAP = 13, 7
_MOST_SHARES = 12


Figures = dict[str, Any]
"""Values for a template, by name."""


def make_variants_page(step: StepInputs) -> None:
    """Write the page of the table of `VARIANTS`."""
    (table,) = step.inputs["tables"]
    atomic_write_text(step.outputs[0], render_variants_page(table))


def render_variants_page(table: str | Path | None) -> str:
    """Return the HTML page of the variants of a table, with the curves of all classifiers.

    Without a table the page shows the kept variants. Raises `ReportError` if the table has no variant that could be run.
    """
    figures = variants_figures(read_variants(table), kept_variants(OUTSIDE))
    if figures is None:
        raise ReportError(f"{table} has no variant that could be run; at least one is needed.")
    environment = make_environment()
    environment.loader = ChoiceLoader(
        [PackageLoader("visuohaptic.report"), PackageLoader("variants")]
    )
    script = _text("variants.js")
    return environment.get_template("frame.html.jinja").render(
        policy=content_policy(script),
        variants=figures,
        written=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        style=page_style() + _text("variants.css"),
        script=script,
    )


def _text(name: str) -> str:
    return files("variants").joinpath("templates", name).read_text("utf-8")


def variants_figures(
    measured: MeasuredVariants,
    outside: MeasuredVariants | None = None,
    classifiers: Sequence[str] = tuple(TABLE_1),
) -> Figures | None:
    """Return the values that the page shows; None if no variant could be run.

    `measured` has the variants on the paper's set, `outside` the variants on objects outside of it. Charts and shares,
    which say how much of the spread each choice explains, are by name of `classifiers`.
    """
    summary = summarise_variants(measured.rows)
    shown = [name for name in classifiers if name in summary["classifiers"]]
    if not shown:
        return None
    best = BEST_OF_PAPER if BEST_OF_PAPER in shown else shown[0]
    return {
        "sentences": _sentences(summary, best),
        "summary": summary,
        "charts": {name: curve_chart(measured.rows, name) for name in shown},
        "shares": {name: _largest(summary["classifiers"][name]["choices"]) for name in shown},
        "choices": CHOICES,
        "source": measured.source,
        "outside": outside_figures(measured.rows, outside) if outside else None,
    }


def variants_sentences(
    measured: MeasuredVariants, outside: MeasuredVariants | None, classifier: str
) -> list[str]:
    """Return the sentences of the page on a classifier; none if no variant with the classifier could be run."""
    summary = summarise_variants(measured.rows)
    if classifier not in summary["classifiers"]:
        return []
    return [
        *_sentences(summary, classifier),
        *(_outside_sentences(outside.rows) if outside else ()),
    ]


def outside_figures(rows: Sequence[Row], outside: MeasuredVariants) -> Figures:
    """Return the leads of fixation on the paper's set, `rows`, beside the leads on other objects, `outside`.

    An option ``turns`` if the median leads on other objects under the options of its choice differ in sign.
    """
    here, there = leads_by_option(rows), leads_by_option(outside.rows)
    turning = {
        choice
        for choice, _ in there
        if len({lead.middle > 0 for (name, _), lead in there.items() if name == choice}) > 1
    }
    options = [
        {
            "choice": BY_NAME[choice].label,
            "option": spaced(option),
            "here": here.get((choice, option)),
            "outside": lead,
            "turns": choice in turning,
        }
        for (choice, option), lead in there.items()
    ]
    return {
        "sentences": list(_outside_sentences(outside.rows)),
        "options": options,
        "objects": _most_objects(outside.rows),
        "source": outside.source,
    }


def _most_objects(rows: Sequence[Row]) -> int:
    return max(row["objects"] or 0 for row in rows)


def _outside_sentences(rows: Sequence[Row]) -> Iterator[str]:
    total = sum_up([row for row in against_main(rows) if row["ahead"] is not None])
    yield (
        f"On {_most_objects(rows)} objects outside the paper's set, fixation is ahead of random probing in "
        f"{total.ahead} of {total.cases} cases (a variant with one classifier), in "
        f"{total.ahead_singly} with p below 0.05, each case tested by itself; it is behind with p below 0.05 in "
        f"{total.behind_singly}. The median lead is {points(total.middle)} points."
    )
    pair = strongest_pair(rows)
    if pair is None:
        return
    ahead, behind = (
        [key for key, lead in pair.leads.items() if sign * lead.middle > 0] for sign in (1, -1)
    )
    first, second = (BY_NAME[name].label for name in pair.choices)
    yield (
        f"Who leads there depends on two choices, which explain {percent(pair.share, 0)} of how leads "
        f"differ: “{first}” and “{second}”. Fixation leads with {_with_leads(pair, ahead)}; random "
        f"probing leads with {_with_leads(pair, behind)} (medians)."
    )


def _with_leads(pair: PairLead, options: Sequence[tuple[str, str]]) -> str:
    """Write pairs of options with their median leads, the largest first."""
    ordered = sorted(options, key=lambda key: -abs(pair.leads[key].middle))
    named = [
        f"{spaced(first)} and {spaced(second)} ({points(pair.leads[first, second].middle)})"
        for first, second in ordered
    ]
    return listed(named) if named else "none"


def curve_chart(rows: Sequence[Row], classifier: str) -> Figures:
    """Return the specification curve of one classifier, variants sorted by accuracy by fixation, as parts of an SVG.

    Values are vertical positions with texts, circles, and paths. The ``whiskers`` are intervals of fixation, ``random``
    marks random probing, and each option has a tick at each of its variants.
    """
    run = _of_the_papers_question(rows, classifier)
    run.sort(key=lambda row: (row["fixation"], row["place"]))
    step = (WIDTH - _LEFT - 10) / len(run)
    placed = [(_LEFT + (index + 0.5) * step, row) for index, row in enumerate(run)]
    base = _TOP + _CURVE_HEIGHT
    labels, options, height = _panel(placed, base + 30)
    return {
        "height": height,
        "base": base,
        "ticks": [(_down(share), f"{share:.0%}") for share in (0, 0.25, 0.5, 0.75, 1)],
        "variants": len(run),
        # A template would take seconds for thousands of dots.
        "dots": Markup("".join(_dot(x, row) for x, row in placed)),  # noqa: S704 - texts are escaped
        "whiskers": "".join(
            f"M{x:.1f} {_down(row['fixation_high']):.0f}V{_down(row['fixation_low']):.0f}"
            for x, row in placed
        ),
        "random": "".join(f"M{x - 1:.1f} {_down(row['random']):.1f}h2" for x, row in placed),
        "published": [
            (strategy, _down(value), f"published, {strategy}: {percent(value, 2)}")
            for strategy, value in TABLE_1[classifier].items()
        ],
        "labels": labels,
        "options": options,
    }


def _dot(x: float, row: Row) -> str:
    """Return the circle of a variant's accuracy by fixation, with a tooltip."""
    centre = f'cx="{round(x, 1)}" cy="{round(_down(row["fixation"]), 1)}"'
    mark = 'r="4" class=own' if is_default(row) else 'r="2"'
    name, label = escape(row["variant"]), escape(_label(row))
    return f'<circle {centre} {mark} data-variant="{name}"><title>{label}</title></circle>'


def _of_the_papers_question(rows: Sequence[Row], classifier: str) -> list[Row]:
    """Return the rows of a classifier that could be run, without part ``protocol``, which asks another question."""
    return [
        row
        for row in against_main(rows)
        if row["classifier"] == classifier and row["error"] is None and row["part"] != "protocol"
    ]


def describe_options(row: Row) -> str:
    """Return the options in which a variant differs from our default, in words."""
    changed = [
        f"{choice.label.lower()}: {spaced(row[choice.name])}"
        for choice in CHOICES
        if row[choice.name] != choice.default
    ]
    return "; ".join(changed) or "our default"


def _panel(
    placed: Sequence[tuple[float, Row]], top: float
) -> tuple[list[tuple[float, str]], list[tuple[float, str, str]], float]:
    labels: list[tuple[float, str]] = []
    options: list[tuple[float, str, str]] = []
    for choice in CHOICES:
        if len({row[choice.name] for _, row in placed}) < 2:
            continue
        labels.append((top + 10, choice.label))
        top += _ROW + 2
        for option in choice.options:
            ticks = "".join(
                f"M{x:.1f} {top:.0f}v{_ROW - 4}" for x, row in placed if row[choice.name] == option
            )
            options.append((top + 8, spaced(option), ticks))
            top += _ROW
        top += _GAP
    return labels, options, top


def _label(row: Row) -> str:
    interval = f"{percent(row['fixation_low'])} to {percent(row['fixation_high'])}"
    return (
        f"{row['variant']}: fixation {percent(row['fixation'])} ({interval}), random "
        f"{percent(row['random'])}. {describe_options(row)}. "
        f"{COMMAND.format(row['variant'])}"
    )


def _down(share: float) -> float:
    return _TOP + (1 - share) * _CURVE_HEIGHT


def _largest(choices: Sequence[Row]) -> list[Row]:
    named = [
        {
            **row,
            "words": listed([BY_NAME[name].label for name in row["choices"]]),
            "gains": _gains(row),
        }
        for row in choices
    ]
    return [
        row
        for part in ("recognition", "upstream")
        for row in [entry for entry in named if entry["part"] == part][:_MOST_SHARES]
        if row["share"] >= 0.005
    ]


def _gains(row: Row) -> str:
    if row["gains"] is None:
        return ""
    base = BY_NAME[row["choices"][0]].base
    return ", ".join(
        f"{spaced(option)} {points(gain)}"
        for option, gain in row["gains"].items()
        if option != base
    )


def _sentences(summary: Mapping[str, Any], classifier: str) -> list[str]:
    figures = summary["classifiers"][classifier]
    count = figures["variants"]
    named = classifier_name(classifier)
    ahead = sum(entry["ahead"] for entry in summary["classifiers"].values())
    cells = sum(entry["variants"] for entry in summary["classifiers"].values())
    reached = [
        f"{classifier_name(name)} {entry['variants_reaching']}"
        for name, entry in summary["classifiers"].items()
    ]
    default = "" if figures["default"] is None else f"; our default {percent(figures['default'])}"
    spread = (
        f"The paper can be read in many ways. Of {count} variants, its best classifier ({named}) has "
        f"{percent(figures['lowest'])} to {percent(figures['highest'])} correctly classified by fixations "
        f"(median {percent(figures['median'])}{default}; published "
        f"{percent(figures['published']['fixation'], 2)})."
    )
    lead = (
        f"Fixations are ahead of random probing in {percent(figures['ahead'] / count, 0)} of the variants, "
        f"with p below 0.05 in {percent(figures['ahead_singly'] / count, 0)} (each tested by itself, not adjusted for "
        f"{count} variants). Half of the leads are above "
        f"{points(figures['ahead_median'])} points; the paper's is {points(figures['published_ahead'])}. "
        f"Over all five classifiers fixations are ahead in {ahead} of {cells} cases."
    )
    best = (
        f"The published figure is reached by {figures['variants_reaching']} of the {count} variants, if all "
        f"splits are averaged as here. A single split is sometimes lucky: "
        f"{percent(figures['splits_reaching'])} of all splits reach it, the best with "
        f"{percent(figures['highest_split'])}, and {figures['variants_with_a_split_reaching']} variants have "
        f"such a split. Variants that reach the paper's figure, by classifier: {listed(reached)}."
    )
    return [spread, lead, best]


if __name__ == "__main__":
    atomic_write_text(sys.argv[1], render_variants_page(None))
