"""An object's class from its touches: the model, the answer, and how both were made."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from visuohaptic.base.errors import RecognitionError

if TYPE_CHECKING:
    import pyarrow as pa

    from visuohaptic.parameters import ExperimentParameters
    from visuohaptic.recognition.model import RecognitionModel

UNKNOWN = "unknown"
"""The name of an object that is of no class that the model knows."""

GIVEN = "given"
"""The strategy of points that the caller chose."""

DEFAULT_MODEL = Path("results/models/recogniser.skops")
"""Where the workflow leaves its recognition model."""

PACKAGED_MODEL = Path(__file__).with_name("recogniser.skops")
"""The model of a default run on the paper's twelve objects, which comes with the package."""

_FREE = ("viewpoints.count", "attention.fixations")


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
            f"{', '.join(self.model.strategies)}: {classes}>"
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
    from visuohaptic.parameters import ExperimentParameters
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
    found = ExperimentParameters.from_mapping(json.loads(model.touching), str(path))
    return Recogniser(model, found)


def caution_about(strategy: str, recogniser: Recogniser) -> str | None:
    """Return a sentence if the model did not learn from touches by this strategy, otherwise None."""
    if recogniser.model.matching_strategy(strategy) is not None:
        return None
    touched = "at given points" if strategy == GIVEN else f"by {strategy}"
    return (
        f"The model learnt from touches by {' and '.join(recogniser.model.strategies)} and these touches were "
        f"made {touched}, so its probabilities are not calibrated for them and it states no prediction set."
    )


def check_acquired(features: pa.Table, touched: ExperimentParameters) -> None:
    """Raise `RecognitionError` if the sensor could reach none of the places of `features`."""
    from visuohaptic.tables.phases import OUT_OF_REACH

    # A sensor of fixed size may have these contact states at places in reach.
    if touched.scene.effects.adaptive_size == "never" or not features.num_rows:
        return
    if set(features.column("contact_state").unique().to_pylist()) <= {*OUT_OF_REACH}:
        raise RecognitionError(
            f"The sensor could reach none of the {features.num_rows} places that it was set down on; touch "
            "one place in reach at least."
        )


def check_alike(touched: ExperimentParameters, recogniser: Recogniser) -> None:
    """Refuse touches that were made with other parameters than the touches that the model learnt from.

    Raises `RecognitionError` if a parameter of touching, or a frame that `touched` sets (`recognition.frame`),
    is not that of the model.
    """
    from visuohaptic.parameters import leaves

    sections = touching_sections()
    _check_frame(touched, recogniser)
    here, there = (
        dict(leaves(parameters.model_dump(include=sections)))
        for parameters in (touched, recogniser.parameters)
    )
    names = sorted(set(here) | set(there))
    covers = {touched.scene.cover, recogniser.parameters.scene.cover}
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


def _check_frame(touched: ExperimentParameters, recogniser: Recogniser) -> None:
    """Refuse a frame that the caller set and the model was not fitted for."""
    # The default is nobody's request: models of all frames are asked with default parameters.
    if "frame" not in touched.recognition.model_fields_set:
        return
    here, there = touched.recognition.frame, recogniser.model.parameters.frame
    if here != there:
        raise RecognitionError(
            f"recognition.frame is {here}, and the model was fitted for {there}; set {there}, or "
            f"fit a model with recognition.frame {here}."
        )


def touching_sections() -> set[str]:
    """Name the sections of the parameters in which a model's touches and an object's must be alike."""
    from visuohaptic.phases import OF_OBJECT

    found = {name.partition(".")[0] for phase in OF_OBJECT for name in phase.sections()}
    return found - {"seed", "probing"}
