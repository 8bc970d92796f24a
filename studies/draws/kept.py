"""The kept draws of random places: accuracies of each draw and leads of fixation, by set of objects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa

from draws.tables import DRAWS
from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.leads import DrawnAccuracies
from visuohaptic.evaluation.means_over_draws import LeadOverDraws, lead_over_draws
from visuohaptic.report.wording import classifier_name, counted, percent_points, points
from visuohaptic.studies.figures import rows_by
from visuohaptic.studies.keeping import Source, kept_files, read_result, read_source

FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class KeptPipeline:
    """Accuracies of one pipeline's classifier by strategy, with one entry per draw of the places."""

    classifier: str
    accuracies: Mapping[str, DrawnAccuracies]


@dataclass(frozen=True)
class KeptSet:
    """The draws of one set of objects.

    `pipelines` also has ``literal``, the paper's pipeline in the most literal variant of the paper.
    """

    source: Source
    pipelines: Mapping[str, KeptPipeline]


@dataclass(frozen=True)
class KeptDraws:
    """The lead of fixation over each kept draw of random places, as shares.

    Attributes
    ----------
    pipeline, opponent, classifier : str
        The pipeline, the strategy of the random places and the classifier; all other parameters have their defaults.
    objects : int
        The number of objects.
    lead : LeadOverDraws
        The lead over each draw.
    source : Source
        The set of objects, the state of the code, and the date of the measurement.
    """

    pipeline: str
    opponent: str
    classifier: str
    objects: int
    lead: LeadOverDraws
    source: Source


def read_kept(folder: Path = FOLDER) -> dict[str, KeptSet]:
    """Read all kept draws in a folder, by set of objects. Raises `ReportError` if a file is damaged."""
    return {name: _read_set(path) for name, path in kept_files(folder).items()}


def _read_set(path: Path) -> KeptSet:
    pipelines = {
        name: KeptPipeline(
            rows["classifier"][0].as_py(),
            {strategy: _accuracies(part) for (strategy,), part in rows_by(rows, ["strategy"]).items()},
        )
        for (name,), rows in rows_by(read_result(DRAWS, path, "draws"), ["pipeline"]).items()
    }  # fmt: skip
    return KeptSet(read_source(path), pipelines)


def _accuracies(rows: pa.Table) -> DrawnAccuracies:
    """Return the accuracies of one strategy, draw by draw."""
    draws = []
    for part in rows_by(rows, ["draw"]).values():
        objects = zip(part["class"].to_pylist(), part["object"].to_pylist(), strict=True)
        columns = (np.array(part[name].to_pylist(), np.float64) for name in ("accuracy", "weight"))
        draws.append(ObjectAccuracies(tuple(objects), *columns))
    return DrawnAccuracies(tuple(draws))


def read_draws(
    name: str, pipeline: str, folder: Path = FOLDER, opponent: str = "random"
) -> KeptDraws | None:
    """Read the kept draws of a set of objects and a pipeline; return None if no draws are kept.

    `name` is the set of objects. `opponent` is the strategy of the random places. Raises `ReportError` if a file is
    damaged.
    """
    kept = read_kept(folder).get(name)
    if kept is None or pipeline not in kept.pipelines:
        return None
    measured = kept.pipelines[pipeline]
    if opponent not in measured.accuracies:
        return None
    (fixation,) = measured.accuracies["fixation"].draws
    return KeptDraws(
        pipeline=pipeline,
        opponent=opponent,
        classifier=measured.classifier,
        objects=len(fixation.objects),
        lead=lead_over_draws(fixation, measured.accuracies[opponent].draws),
        source=kept.source,
    )


def kept_sentence(kept: KeptDraws) -> str:
    """Return a sentence on the range and the standard deviation of the lead over kept draws."""
    leads, source = kept.lead.leads, kept.source
    commit, *edited = source.commit.partition(",")
    return (
        f"In {counted(kept.lead.count, 'draw')} of random places that are kept with the study "
        f"({counted(kept.objects, 'object')} of set {source.set}, pipeline {kept.pipeline}, {classifier_name(kept.classifier)}, default parameters, commit "
        f"{commit[:12]}{''.join(edited)}) the lead of fixation lies between {points(min(leads))} and {points(max(leads))} "
        f"points, standard deviation {percent_points(kept.lead.standard_deviation)}."
    )
