"""Kept draws of random places: measured once and stored with the package, by set of objects.

`make draws` measures them and writes `draws.json` beside this file (studies/draws/README.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict

from visuohaptic.base.arrays import FloatArray
from visuohaptic.evaluation.draws import LeadOverDraws, ObjectAccuracies, lead_over_draws
from visuohaptic.evaluation.leads import DrawnAccuracies
from visuohaptic.report.estimates import read_json
from visuohaptic.report.wording import classifier_name, counted, percent_points, points

KEPT = "draws.json"


class KeptPipeline(BaseModel):
    """Accuracies of one pipeline's headline classifier per object; None where an object was not tested.

    `weights` are the objects' weights by fixation. `draws` has, by random strategy, one list of accuracies per draw of
    the places.
    """

    model_config = ConfigDict(frozen=True)

    classifier: str
    weights: tuple[float | None, ...]
    fixation: tuple[float | None, ...]
    draws: dict[str, tuple[tuple[float | None, ...], ...]]


class KeptSet(BaseModel):
    """The draws of one set of objects, ``class/name``, with the commit and the date (UTC) of the measurement.

    `pipelines` also has ``literal``, the paper's pipeline in the most literal variant of the paper.
    """

    model_config = ConfigDict(frozen=True)

    commit: str
    date: str
    objects: tuple[str, ...]
    pipelines: dict[str, KeptPipeline]


@dataclass(frozen=True)
class KeptDraws:
    """The lead of fixation over each kept draw of random places, as shares.

    Attributes
    ----------
    set, pipeline, opponent, classifier : str
        The set of objects, the pipeline, the strategy of the random places and the classifier; all other parameters
        have their defaults.
    objects : int
        The number of objects.
    fixation : float
        The accuracy by fixation.
    random : tuple of float
        The accuracy of each draw.
    lead : LeadOverDraws
        The lead over each draw.
    commit, date : str
        The state of the code, and the date of the measurement.
    """

    set: str
    pipeline: str
    opponent: str
    classifier: str
    objects: int
    fixation: float
    random: tuple[float, ...]
    lead: LeadOverDraws
    commit: str
    date: str


def read_draws(
    name: str, pipeline: str, path: Path | None = None, opponent: str = "random"
) -> KeptDraws | None:
    """Read the kept draws of a set of objects, a pipeline and a strategy of random places.

    Parameters
    ----------
    name : str
        The set of objects.
    pipeline : str
        The pipeline.
    path : Path, optional
        A file that `make draws` wrote; by default the file of the package.
    opponent : str
        The strategy of the random places.

    Returns
    -------
    KeptDraws or None
        The draws; None where none are kept.

    Raises
    ------
    ReportError
        If the file is damaged.
    """
    kept = read_kept(path).get(name)
    if kept is None or pipeline not in kept.pipelines:
        return None
    measured = kept.pipelines[pipeline]
    by_strategy = kept_accuracies(kept, pipeline)
    if opponent not in by_strategy:
        return None
    (fixation,), random = by_strategy["fixation"].draws, by_strategy[opponent].draws
    return KeptDraws(
        set=name,
        pipeline=pipeline,
        opponent=opponent,
        classifier=measured.classifier,
        objects=len(fixation.objects),
        fixation=fixation.mean,
        random=tuple(draw.mean for draw in random),
        lead=lead_over_draws(fixation, random),
        commit=kept.commit,
        date=kept.date,
    )


def kept_accuracies(kept: KeptSet, pipeline: str) -> dict[str, DrawnAccuracies]:
    """Return the accuracies of a kept pipeline by strategy, with one entry per draw."""
    measured = kept.pipelines[pipeline]
    lists = {"fixation": (measured.fixation,), **measured.draws}
    return {
        strategy: DrawnAccuracies(
            tuple(
                tested_accuracies(kept.objects, accuracies, measured.weights)
                for accuracies in draws
            )
        )
        for strategy, draws in lists.items()
    }


def read_kept(path: Path | None = None) -> dict[str, KeptSet]:
    """Read all kept draws, by set of objects; `path` and errors as in `read_draws`."""
    return read_json(
        Path(str(files("visuohaptic.report").joinpath(KEPT))) if path is None else path,
        lambda stored: {name: KeptSet.model_validate(draws) for name, draws in stored.items()},
        "holds no kept draws",
        "run `make draws` again",
    )


def kept_sentence(kept: KeptDraws) -> str:
    """Return a sentence on the range and the standard deviation of the lead over kept draws."""
    leads = kept.lead.leads
    commit, *edited = kept.commit.partition(",")
    return (
        f"In {counted(kept.lead.count, 'draw')} of random places that are kept with the package "
        f"({counted(kept.objects, 'object')} of set {kept.set}, pipeline {kept.pipeline}, {classifier_name(kept.classifier)}, default parameters, commit "
        f"{commit[:12]}{''.join(edited)}) the lead of fixation lies between {points(min(leads))} and {points(max(leads))} "
        f"points, standard deviation {percent_points(kept.lead.standard_deviation)}."
    )


def tested_accuracies(
    objects: tuple[str, ...], values: tuple[float | None, ...], weights: tuple[float | None, ...]
) -> ObjectAccuracies:
    """Return the accuracies and weights of objects, ``class/name``, without objects that were not tested (None)."""
    numbers: FloatArray = np.array([values, weights], dtype=np.float64)
    tested = np.flatnonzero(np.isfinite(numbers).all(axis=0))
    names = [objects[index].partition("/") for index in tested]
    return ObjectAccuracies(
        tuple((category, name) for category, _, name in names), *numbers[:, tested]
    )
