"""The sections of the report on prediction sets, on objects of no known class, and on untypical objects."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
from matplotlib.figure import Figure

from trust.odd import odd_sentence
from trust.study import STUDY
from trust.tables import STATED_COVERAGES, TRUST
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition.parameters import least_known_objects, least_objects
from visuohaptic.report.drawing import COLOURS, style
from visuohaptic.report.estimates import Row, read_json
from visuohaptic.report.figures import draw_lines, label_axes, whole_percent
from visuohaptic.report.held_out import rows_of
from visuohaptic.report.section import (
    OTHER_OBJECTS,
    ReportContext,
    Section,
    SourceTable,
    Values,
    sentences_section,
)
from visuohaptic.tables.schema import read_table

TABLE, FIGURES = STUDY.shown


def trust_figures(table: Path, figures: Path) -> Row:
    """Read the table `TRUST` and its figures, as ``rows`` by strategy and number of views.

    With fewer than ``least`` training objects, sets of the ``stated`` coverage hold all classes; with fewer than
    ``least_unknown``, answers of a model call no object unknown. ``enough`` is whether any set left out a class.
    """
    way_out = "run `snakemake -j2 trust_all` again"
    rows = read_json(figures, rows_of, "holds no figures of study trust", way_out)
    measured = read_table(TRUST, table)
    classes = len(measured.column("left_out").unique())
    return {
        "table": measured,
        "rows": rows,
        "views": max(row["views"] for row in rows),
        "stated": rows[0]["stated"],
        "least": least_objects(rows[0]["stated"]),
        "least_unknown": least_known_objects(rows[0]["stated"]),
        "classes": classes,
        "enough": any(row["set_size"] < classes - 1 for row in rows),
    }


def trust_values(context: ReportContext) -> Values | None:
    """Return the values of the section; None if the run has no figures of the study."""
    table, figures = context.run.existing_file(TABLE), context.run.existing_file(FIGURES)
    if not table or not figures:
        return None
    return {"trust": trust_figures(table, figures), "draw_coverage": coverage}


@style()
def coverage(table: pa.Table) -> Figure:
    """Draw the share of known objects with their class in the set against the stated coverage.

    `table` has rows of `TRUST`; only rows with the largest number of views are drawn.
    """
    most = select(table, views=max(table.column("views").to_pylist()), known=True)
    stated = np.array(STATED_COVERAGES) / 100
    lines = {}
    for strategy in dict.fromkeys(most.column("strategy").to_pylist()):
        held = select(most, strategy=strategy).column("covered_at").to_pylist()
        lines[strategy] = (
            stated,
            [np.mean([percent in sets for sets in held]) for percent in STATED_COVERAGES],
        )
    chart, axes = draw_lines(lines, 190, "as stated")
    ends = [stated[0], 1]
    axes.plot(ends, ends, color=COLOURS["ink"], linestyle="--", linewidth=1, label="as stated")
    axes.set_ylim(0, 1.02)
    return label_axes(
        chart,
        "stated coverage",
        "share of the objects",
        xformat=whole_percent,
        yformat=whole_percent,
    )


def odd_sentences(context: ReportContext) -> Iterator[str]:
    """Yield the sentence on untypical objects, if no model was evaluated on objects of this run."""
    if context.run.extra_path("evaluation") is None:
        yield odd_sentence(context.run.parameters.recognition.intervals)


SECTIONS = (
    Section(
        STUDY.name,
        STUDY.title,
        trust_values,
        (SourceTable("Known and unknown objects", TRUST, TABLE),),
    ),
    sentences_section("odd", "Untypical objects", odd_sentences, OTHER_OBJECTS),
)
