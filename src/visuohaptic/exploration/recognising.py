"""An object's class from its touches: the model, the answer, and how both were made."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from visuohaptic.errors import RecognitionError

if TYPE_CHECKING:
    from visuohaptic.exploration.exploring import Exploration
    from visuohaptic.parameters import ExperimentParameters
    from visuohaptic.recognition.model import RecognitionModel

UNKNOWN = "unknown"
"""The name of an object that is of no class that the model knows."""

DEFAULT_MODEL = Path("results/models/best.skops")
"""Where the workflow leaves its recognition model."""

PACKAGED_MODEL = Path(__file__).with_name("best.skops")
"""The model of a default run on the paper's twelve objects, which comes with the package."""

_TOUCHING_SECTIONS = ("viewpoints", "rendering", "attention", "sensor", "scene", "features")
_FREE = ("viewpoints.count", "attention.fixations")


@dataclass(frozen=True, eq=False)
class Recognition:
    """What an object was named; it is equal to itself alone.

    Attributes
    ----------
    name : str
        The likeliest class, or ``unknown`` where the object is of no class that the model knows.
    probabilities : mapping of str to float
        Of every class that the model knows, the likeliest first.
    exploration : Exploration
        What the answer rests on.
    touches : int
        Touches that the answer rests on.
    seconds : mapping of str to float
        What each phase took: prepare, look, touch, describe, name.
    candidates : tuple of str or None
        The prediction set, the likeliest first, made so that of objects of known classes the share
        `coverage` has its class in it, which is measured and not guaranteed (docs/recognition.md). None, as
        all that follows, where the model is not calibrated.
    strangeness : float or None
        The share of known objects, this one counted among them, that are less strange than it.
    unknown : bool or None
        Whether that is more than `coverage`.
    coverage : float or None
        The stated share.
    """

    name: str
    probabilities: Mapping[str, float]
    exploration: Exploration
    touches: int
    seconds: Mapping[str, float]
    candidates: tuple[str, ...] | None = None
    strangeness: float | None = None
    unknown: bool | None = None
    coverage: float | None = None

    def __repr__(self) -> str:
        from visuohaptic.exploration.showing import probability_line

        line = probability_line(self.probabilities)
        if self.unknown:
            line = f"{UNKNOWN} ({line})"
        return f"<Recognition of {self.exploration.key}: {line}; from {self.touches} touches>"

    def _repr_html_(self) -> str:
        from visuohaptic.exploration.showing import probability_table

        key = self.exploration.key
        named = f"{key}: {UNKNOWN}" if self.unknown else key
        return probability_table(named, self.probabilities, self.touches)


@dataclass(frozen=True, eq=False)
class Recogniser:
    """A recognition model, and how the touches were made from which it learnt."""

    model: RecognitionModel
    parameters: ExperimentParameters

    def __repr__(self) -> str:
        classifier = self.model.classifier.replace("_", " ")
        classes = ", ".join(self.model.classes)
        return (
            f"<Recogniser: {classifier}, which learnt {len(self.model.objects)} objects touched by "
            f"{self.model.strategy}: {classes}>"
        )


def default_model() -> Path:
    """Name the model of the run in this folder, or where there is none the one that comes with the package."""
    return DEFAULT_MODEL if DEFAULT_MODEL.exists() else PACKAGED_MODEL


def read_recogniser(path: str | Path | None = None) -> Recogniser:
    """Read a recognition model and the parameters in it.

    Parameters
    ----------
    path : path, optional
        The ``.skops`` file, which also holds how its touches were made; without it that of
        `default_model`.

    Returns
    -------
    Recogniser
        The model and its parameters.

    Raises
    ------
    RecognitionError
        If it is missing, or can't be read safely.
    """
    from visuohaptic.parameters import check_parameters
    from visuohaptic.recognition.stored_models import load_model

    path = default_model() if path is None else Path(path)
    if path.is_dir():
        raise RecognitionError(
            f"{path} is a folder; the model in it is needed, such as {path / DEFAULT_MODEL.name}."
        )
    if not path.is_file():
        raise RecognitionError(
            f"{path} is not there, and recognition needs it; `snakemake -j2 model_all` fits a "
            f"model and writes {DEFAULT_MODEL}."
        )
    model = load_model(path)
    if model.touching is None:
        raise RecognitionError(
            f"{path} does not say how the touches were made from which it learnt; `snakemake -j2 "
            "model_all` fits one that does."
        )
    return Recogniser(model, check_parameters(json.loads(model.touching), str(path)))


def check_alike(exploration: Exploration, recogniser: Recogniser) -> None:
    """Refuse touches that were made in another way than those that the model learnt from."""
    from visuohaptic.parameters import leaves

    if exploration.strategy != recogniser.model.strategy:
        raise RecognitionError(
            f"The object was touched by {exploration.strategy} and the model learnt from touches by "
            f"{recogniser.model.strategy}; touch with strategy {recogniser.model.strategy!r}."
        )
    here, there = (
        dict(leaves(parameters.model_dump(include=set(_TOUCHING_SECTIONS))))
        for parameters in (exploration.parameters, recogniser.parameters)
    )
    names = sorted(set(here) | set(there))
    covers = {exploration.parameters.scene.cover, recogniser.parameters.scene.cover}
    # A sensor without a cover measures shapes, whatever the object's real size is.
    free = (*_FREE, "scene.object_radius_m") if covers == {"none"} else _FREE
    unlike = [name for name in names if here.get(name) != there.get(name) and name not in free]
    if unlike:
        found = ", ".join(
            f"{name} {here.get(name)} (the model's is {there.get(name)})" for name in unlike
        )
        raise RecognitionError(
            f"The object was touched with {found}; touch it with the model's own parameters."
        )
