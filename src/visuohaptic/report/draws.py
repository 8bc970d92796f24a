"""Draws of random places that were measured once and are kept with the package, by set of objects.

`make draws` measures them and writes `draws.json` beside this file (studies/draws/README.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict

from visuohaptic.base.arrays import FloatArray
from visuohaptic.evaluation.draws import Draw, LeadOverDraws, lead_over_draws
from visuohaptic.report.estimates import read_json
from visuohaptic.report.wording import classifier_name, counted, percent_points, points

KEPT = "draws.json"


class KeptPipeline(BaseModel):
    """Accuracies of one pipeline's headline classifier per object, None where an object was not tested.

    `weights` are those of objects by fixation; `random` has one list per draw of the places.
    """

    model_config = ConfigDict(frozen=True)

    classifier: str
    weights: tuple[float | None, ...]
    fixation: tuple[float | None, ...]
    random: tuple[tuple[float | None, ...], ...]


class KeptSet(BaseModel):
    """The draws of one set of objects, ``class/name``, with the commit and the day (UTC) of the measurement."""

    model_config = ConfigDict(frozen=True)

    commit: str
    date: str
    objects: tuple[str, ...]
    pipelines: dict[str, KeptPipeline]


@dataclass(frozen=True)
class KeptDraws:
    """How far fixation leads each kept draw of random places, as shares.

    Attributes
    ----------
    set, pipeline, classifier : str
        What was measured, with all other parameters at their defaults.
    objects : int
        The number of objects.
    fixation : float
        The accuracy by fixation.
    random : tuple of float
        The accuracy of each draw.
    lead : LeadOverDraws
        The lead over each draw.
    commit, date : str
        State of the code, and day of the measurement.
    """

    set: str
    pipeline: str
    classifier: str
    objects: int
    fixation: float
    random: tuple[float, ...]
    lead: LeadOverDraws
    commit: str
    date: str


def read_draws(name: str, pipeline: str, path: Path | None = None) -> KeptDraws | None:
    """Read the kept draws of a set of objects and a pipeline; None where none are kept.

    `path` is a file as `make draws` writes; without it, that of the package. Raises `ReportError` if the file is
    damaged.
    """
    kept = read_kept(path).get(name)
    if kept is None or pipeline not in kept.pipelines:
        return None
    found = kept.pipelines[pipeline]
    fixation = _draw(kept.objects, found.fixation, found.weights)
    random = [_draw(kept.objects, one, found.weights) for one in found.random]
    return KeptDraws(
        set=name,
        pipeline=pipeline,
        classifier=found.classifier,
        objects=len(fixation.objects),
        fixation=fixation.mean,
        random=tuple(one.mean for one in random),
        lead=lead_over_draws(fixation, random),
        commit=kept.commit,
        date=kept.date,
    )


def read_kept(path: Path | None = None) -> dict[str, KeptSet]:
    """Read all kept draws, by set of objects."""
    return read_json(
        Path(str(files("visuohaptic.report").joinpath(KEPT))) if path is None else path,
        lambda found: {name: KeptSet.model_validate(one) for name, one in found.items()},
        "holds no kept draws",
        "run `make draws` again",
    )


def kept_sentence(kept: KeptDraws) -> str:
    """Say between which ends the lead lies in kept draws, and how far one draw moves the lead."""
    leads = kept.lead.leads
    commit, *edited = kept.commit.partition(",")
    return (
        f"In {counted(kept.lead.count, 'draw')} of random places that are kept with the package "
        f"({counted(kept.objects, 'object')} of set {kept.set}, pipeline {kept.pipeline}, {classifier_name(kept.classifier)}, default parameters, commit "
        f"{commit[:12]}{''.join(edited)}) the lead of fixation lies between {points(min(leads))} and {points(max(leads))} "
        f"points, standard deviation {percent_points(kept.lead.standard_deviation)}."
    )


def _draw(
    objects: tuple[str, ...], values: tuple[float | None, ...], weights: tuple[float | None, ...]
) -> Draw:
    numbers: FloatArray = np.array([values, weights], dtype=np.float64)
    tested = np.flatnonzero(np.isfinite(numbers).all(axis=0))
    names = [objects[place].partition("/") for place in tested]
    return Draw(tuple((first, last) for first, _, last in names), *numbers[:, tested])
