"""Kept answers of models of the 142 objects of set `benchmark` for the 22 untypical objects of set `odd`."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.held_out import held_out_figures
from visuohaptic.report.wording import counted, percent
from visuohaptic.studies.keeping import kept_file, read_source
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import EVALUATION

KEPT = kept_file(Path(__file__).parent, "odd")


def odd_sentence(intervals: IntervalParameters) -> str:
    """Return the sentence on the kept answers by fixation, from the largest number of views."""
    figures = held_out_figures(read_table(EVALUATION, KEPT), intervals)
    row = max(
        (row for row in figures["rows"] if row["strategy"] == "fixation"),
        key=lambda row: int(row["views"]),
    )
    return (
        f"Pipeline order_free classifies {percent(row['accuracy'].mean, 0)} of {figures['objects']} untypical objects of "
        f"set odd correctly from {counted(row['views'], 'view')} (measured on {read_source(KEPT).date}). Its prediction "
        f"sets should contain the true class of {percent(row['stated'], 0)} of objects. Of these objects the sets "
        f"contain the class of {percent(row['coverage'].mean, 0)}."
    )
