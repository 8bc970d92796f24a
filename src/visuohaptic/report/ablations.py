"""Ablations: what each part of the method is worth, in rows and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visuohaptic.report.comparison import PAPER_PIPELINE, SIGNIFICANCE, holm
from visuohaptic.report.wording import counted, listed, percent, points, probability, spaced
from visuohaptic.studies.ablations.settings import ABLATIONS, WHOLE
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import ABLATIONS as ABLATIONS_SCHEMA

Row = Mapping[str, Any]

NAMES = {
    "whole_method": "whole method",
    "contourlet_only": "contourlet bands as the only descriptor of the imprint",
    "nonsubsampled_contourlet": "nonsubsampled contourlet instead",
    "wavelet": "wavelet (db2, three levels) instead",
    "image_statistics": "statistics of the raw imprint instead",
    "cutaneous_only": "cutaneous cues only",
    "kinesthetic_only": "kinesthetic cues only",
    "fixed_sensor_size": "sensor of fixed size",
    "without_map": "no self-organising map",
    "ideal": "scene ideal",
    "fsr400": "scene fsr400",
    "worn_fsr": "scene worn_fsr",
}
REMADE = {
    "nothing": "nothing but the recognition",
    "descriptors": "descriptors",
    "touches": "touches",
    "views": "views, fixations and touches",
}


@dataclass(frozen=True)
class AblationTable:
    """One pipeline's ablations; rows are those of `tables.ABLATIONS` with `adjusted_p`."""

    pipeline: str
    classifier: str
    sentence: str
    rows: Sequence[Row]


def ablation_tables(path: str | Path | None) -> list[AblationTable]:
    """Read the ablations.

    Parameters
    ----------
    path : path or None
        `tables.ABLATIONS`.

    Returns
    -------
    list of AblationTable
        The paper's pipeline first; empty where nothing was measured.
    """
    if path is None or not Path(path).is_file():
        return []
    rows = read_table(ABLATIONS_SCHEMA, path).to_pylist()
    names = list(ABLATIONS)
    rows.sort(key=lambda row: names.index(row["ablation"]))
    keys = sorted({(row["pipeline"], row["classifier"]) for row in rows})
    keys.sort(key=lambda key: key[0] != PAPER_PIPELINE)
    return [
        _table(*key, [row for row in rows if (row["pipeline"], row["classifier"]) == key])
        for key in keys
    ]


def ablation_name(name: str) -> str:
    """Give an ablation's name in words."""
    if name in NAMES:
        return NAMES[name]
    return f"channel {spaced(name.removeprefix('without_'))} left out"


def remade_name(name: str) -> str:
    """Say what an ablation made anew."""
    return REMADE[name]


def _table(pipeline: str, classifier: str, rows: Sequence[Row]) -> AblationTable:
    others = [row for row in rows if row["ablation"] != WHOLE.name]
    adjusted = holm([row["p_value"] for row in others])
    of_name = {row["ablation"]: value for row, value in zip(others, adjusted, strict=True)}
    full = [{**row, "adjusted_p": of_name.get(row["ablation"])} for row in rows]
    return AblationTable(pipeline, classifier, _sentence(full), full)


def _sentence(rows: Sequence[Row]) -> str:
    others = [row for row in rows if row["adjusted_p"] is not None]
    if not others:
        return ""
    worst = max(others, key=lambda row: row["loss"])
    better = sorted((row for row in others if row["loss"] < 0), key=lambda row: row["loss"])
    settled = [row for row in others if row["adjusted_p"] < SIGNIFICANCE]
    text = (
        f"The whole method names {percent(_whole(rows)['accuracy'])} rightly. The largest loss is that of "
        f"{ablation_name(worst['ablation'])}, {points(-worst['loss'])} percentage points"
        if worst["loss"] > 0
        else f"The whole method names {percent(_whole(rows)['accuracy'])} rightly, and nothing that is taken "
        "away or exchanged makes it worse"
    )
    if better:
        gains = [f"{ablation_name(row['ablation'])} ({points(-row['loss'])})" for row in better[:3]]
        if len(better) > 3:
            gains.append(counted(len(better) - 3, "other"))
        text += f"; accuracy is higher with {listed(gains)}"
    objects = counted(others[0]["objects"], "object")
    if not settled:
        least = probability(min(row["adjusted_p"] for row in others))
        return (
            f"{text}. With {objects} no change is beyond chance (smallest Holm-adjusted p {least})."
        )
    names = listed([ablation_name(row["ablation"]) for row in settled])
    return (
        f"{text}. Beyond chance with {objects} (Holm-adjusted p below {SIGNIFICANCE:g}): {names}."
    )


def _whole(rows: Sequence[Row]) -> Row:
    return next(row for row in rows if row["ablation"] == WHOLE.name)
