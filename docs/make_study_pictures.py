"""Draw the pictures of the studies' pages that have no tables to fill: `make readme`."""

from __future__ import annotations

from collections.abc import Callable

from filling import DOCS, kept_figures, read_json, resized, save_picture
from make_claims import KEPT as CLAIMS
from make_claims import draw as draw_changes
from matplotlib.figure import Figure

from human_gaze.agreement_means import summarise
from human_gaze.section import KEPT as GAZE
from human_gaze.tables import AGREEMENT
from visuohaptic.report.estimates import Estimate, estimate
from visuohaptic.report.figures import Series, draw_intervals
from visuohaptic.report.wording import classifier_name
from visuohaptic.tables.schema import read_table

STUDIES = DOCS.parent / "studies"
TAKEN_AWAY = {
    "skin alone": "imprints only",
    "pose alone": "positions and normals only",
    "without the map": "no self-organising map",
    "order shuffled": "order of touches shuffled",
    "sensor of fixed size": "sensor of fixed size",
}
"""Conditions of study `claims` that take a part of the method away."""


def ablations() -> Figure:
    """Draw the change of accuracy by fixation on the largest set where a part is taken away."""
    return draw_changes(kept_figures(CLAIMS)["benchmark"], TAKEN_AWAY)


def classifier_settings() -> Figure:
    """Draw the accuracy of each classifier with its best setting on the tuning objects."""
    accuracies = read_json(STUDIES / "classifier_settings/chosen.json")["accuracy"]
    best = {classifier_name(name): max(tried.values()) for name, tried in accuracies.items()}
    return _ranked(best, "classifier")


def frame_descriptors() -> Figure:
    """Draw the accuracy of each family of descriptors on the tuning objects."""
    return _ranked(read_json(STUDIES / "frame_descriptors/chosen.json")["accuracy"], "family")


def human_gaze() -> Figure:
    """Draw the correlation of each prediction with people's gaze, held-out objects."""
    rows = summarise(read_table(AGREEMENT, GAZE), "training")
    found = [estimate(row.measures["correlation"]) for row in rows]
    labels = [row.predictor.label for row in rows]
    chart = draw_intervals(labels, "prediction", [Series("", 0, found)])
    (axes,) = chart.axes
    axes.set_xlabel("correlation with people's gaze")
    axes.set_xlim(-0.05, 0.65)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set_yticks(range(len(labels)), labels)
    return resized(chart, 380)


def _ranked(accuracies: dict[str, float], rows_are: str) -> Figure:
    """Draw accuracies in the order of their size."""
    ranked = sorted(accuracies.items(), key=lambda item: -item[1])
    found = [Estimate(accuracy) for _, accuracy in ranked]
    return draw_intervals([name for name, _ in ranked], rows_are, [Series("", 0, found)])


DRAWN: tuple[Callable[[], Figure], ...] = (
    ablations,
    classifier_settings,
    frame_descriptors,
    human_gaze,
)
"""What to draw; each function has the name of its study."""

if __name__ == "__main__":
    for draw in DRAWN:
        name = draw.__name__
        save_picture(draw(), STUDIES / name / f"{name}.png")
