"""Attention compared with human gaze: means over objects, what is ahead of what, and pictures."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.gaze.stored import MeasuredGaze
from visuohaptic.gaze.summary import PredictorRow, beside_peer, summarise
from visuohaptic.report.estimates import Row, estimate, with_interval
from visuohaptic.report.pictures import data_uri
from visuohaptic.report.wording import decimal
from visuohaptic.tables.gaze import GAZE_PICTURES
from visuohaptic.tables.schema import read_table

WORST_NAMED = 6


def gaze_figures(measured: MeasuredGaze | None, pictures: Path | None = None) -> Row | None:
    """Give what the page shows; None where nothing was measured.

    ``rows`` are of objects held out in turn, ``tests`` of those for tests, ``peer`` of those that others
    predicted, with gains over them; ``shown`` are equal weights, the best floor, place alone, and the chosen terms.
    """
    rows = [] if measured is None else summarise(measured.table, "training")
    if measured is None or not rows:
        return None
    held = [row for row in measured.table.to_pylist() if row["predictor"] == "human"]
    held.sort(key=lambda row: (row["correlation"], row["object"]))
    shown_pictures = read_table(GAZE_PICTURES, [pictures]).to_pylist() if pictures else []
    by_name = {row.predictor.name: row for row in rows}
    floors = [row for row in rows if row.predictor.kind == "floor"]
    best_floor = max(floors, key=lambda row: row.measures["correlation"].mean)
    shown = by_name["equal"], best_floor, by_name["place"], by_name["chosen"]
    return {
        "sentence": _sentence(*shown),
        "rows": rows,
        "tests": summarise(measured.table, "test"),
        "peer": beside_peer(measured.table),
        "shown": shown,
        "worst": held[:WORST_NAMED],
        "pictures": [
            {**row, "source": data_uri(row["picture"], "image/png")}
            for row in sorted(shown_pictures, key=lambda row: row["rank"])
        ],
        "largest_error": max(row["alignment_error"] for row in held),
        "origin": measured.origin,
    }


def _sentence(
    equal: PredictorRow, floor: PredictorRow, placed: PredictorRow, chosen: PredictorRow
) -> str:
    own, least, place, most = (
        with_interval(estimate(row.measures["correlation"]), decimal)
        for row in (equal, floor, placed, chosen)
    )
    return (
        f"On {equal.objects} objects the saliency map's correlation with the time that people looked at "
        f"each place is {own} with equal weights of its channels; {floor.predictor.label}, which needs no "
        f"model, gives {least}; weights fitted to other objects, with terms such as height, give {most}. "
        f"Place on the object alone, up and to the front, reaches {place}, which holds for objects that "
        "stand upright and face the front."
    )
