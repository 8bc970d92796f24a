"""Fill the tables of README.md from the kept tables: `make readme` and `make learned`."""

from __future__ import annotations

import textwrap
from pathlib import Path

import numpy as np
import pandas as pd
from filling import fill_page, table

from classifier_settings.half import choosing_objects
from learned.study import FRAMES, STRATEGIES, TOUCHES
from visuohaptic.evaluation.intervals import PairedComparison
from visuohaptic.evaluation.leads import compare_accuracies
from visuohaptic.evaluation.means_over_draws import ObjectAccuracies
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.report.estimates import estimate, with_interval
from visuohaptic.report.leads import KNOWN
from visuohaptic.report.wording import percent, points, strategy_name
from visuohaptic.studies.keeping import kept_files, read_source

FOLDER = Path(__file__).parent
PAGE = FOLDER / "README.md"
INTERVALS = IntervalParameters()


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    heads = ["held-out objects", "known of the pose", "touches", "touches by"]
    heads += ["`order_free`", "`learned`", "`learned` minus `order_free`"]
    lines, sources = [], []
    for path in kept_files(FOLDER).values():
        source, rows = read_source(path), pd.read_parquet(path)
        held_out = rows[~rows["object"].isin(choosing_objects())]
        number = held_out["object"].nunique()
        lines += [[number, *line] for line in comparison_lines(held_out)]
        sources.append(f"{number} objects: {source.commit[:12]}, {source.date}")
    text = f"Measured once and kept; {'; '.join(sources)}."
    return {
        "comparison": table(heads, lines),
        "sources": textwrap.fill(text, 100, break_on_hyphens=False),
    }


def comparison_lines(rows: pd.DataFrame) -> list[list[object]]:
    """Return the accuracies of both pipelines and their difference, one line per frame, touches and strategy."""
    lines: list[list[object]] = []
    for frame in reversed(FRAMES):
        for touches in reversed(TOUCHES):
            for strategy in STRATEGIES:
                ours, learned = (
                    accuracies(rows, frame, touches, strategy, pipeline)
                    for pipeline in ("order_free", "learned")
                )
                cells = [KNOWN[frame], touches, strategy_name(strategy)]
                shares = [percent(own.mean) for own in (ours, learned)]
                difference = compare(learned, ours)
                text = with_interval(estimate(difference.difference), points)
                lines.append([*cells, *shares, text.replace("\N{NO-BREAK SPACE}", " ")])
    return lines


def accuracies(
    rows: pd.DataFrame, frame: Frame, touches: int, strategy: str, pipeline: str
) -> ObjectAccuracies:
    """Return the objects' accuracies in a condition."""
    chosen = rows[
        (rows["frame"] == frame)
        & (rows["touches"] == touches)
        & (rows["strategy"] == strategy)
        & (rows["pipeline"] == pipeline)
    ].sort_values("object")
    keys = tuple((name.split("/")[0], name.split("/")[1]) for name in chosen["object"])
    return ObjectAccuracies(keys, *chosen[["accuracy", "weight"]].to_numpy(np.float64).T)


def compare(first: ObjectAccuracies, second: ObjectAccuracies) -> PairedComparison:
    """Compare two pipelines in pairs over objects: first minus second."""
    compared = compare_accuracies(first, second, INTERVALS)
    if compared is None:
        raise LookupError("The pipelines have no object in common.")
    return compared


if __name__ == "__main__":
    fill_page(PAGE, blocks())
