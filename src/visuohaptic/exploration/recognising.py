"""Recognition models with the parameters of their training touches, and checks that a model fits new touches."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.quick_imports import quick_imports

if TYPE_CHECKING:
    import pyarrow as pa

    from visuohaptic.parameters import ExperimentParameters
    from visuohaptic.recognition.model import ModelAnswer, RecognitionModel

UNKNOWN = "unknown"
"""`Recognition.name` of an object that seems to be of no class of the model."""

GIVEN = "given"
"""Name of the strategy in tables of touches at points that the caller gave."""

DEFAULT_MODEL = Path("results/models/recogniser.skops")
"""The model file that the workflow writes, relative to the working directory."""

PACKAGED_MODEL = Path(__file__).with_name("recogniser.skops")
"""The model file of the package, fitted on objects of set ``all`` by a written rule (studies/packaged_model)."""

_MAY_DIFFER = ("viewpoints.count", "attention.fixations")
"""Parameters that may differ between the touches of an object and the training touches of a model."""


@dataclass(frozen=True, eq=False)
class Recogniser:
    """A recognition model with the parameters of its training touches. Recognisers are compared by identity.

    Attributes
    ----------
    model : RecognitionModel
        The fitted model.
    parameters : ExperimentParameters
        Parameters of the training touches. The settings of the fit are `model.parameters`.
    """

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
    """Return `DEFAULT_MODEL` if the file exists in the working directory, otherwise `PACKAGED_MODEL`."""
    return DEFAULT_MODEL if DEFAULT_MODEL.exists() else PACKAGED_MODEL


def read_recogniser(path: str | Path | None = None) -> Recogniser:
    """Read a recognition model and the parameters of its training touches.

    Parameters
    ----------
    path : path, optional
        The ``.skops`` file; by default that of `default_model`.

    Returns
    -------
    Recogniser

    Raises
    ------
    RecognitionError
        If the file is missing, is not a model that can be read safely, or lacks the parameters of the touches.
    """
    from visuohaptic.parameters import ExperimentParameters

    with quick_imports():
        from visuohaptic.recognition.stored_models import load_model

    path = default_model() if path is None else Path(path)
    if path.is_dir():
        raise RecognitionError(
            f"{path} is a folder; the model in it is needed, such as {path / DEFAULT_MODEL.name}."
        )
    if not path.exists():
        raise RecognitionError(
            f"{path} does not exist, and recognition needs a model; `snakemake -j2 model_all` fits a "
            f"model and writes {DEFAULT_MODEL}."
        )
    model = load_model(path)
    if model.touching is None:
        raise RecognitionError(
            f"{path} lacks the parameters of its training touches; `snakemake -j2 model_all` fits a "
            "model with them."
        )
    parameters = ExperimentParameters.from_mapping(json.loads(model.touching), str(path))
    return Recogniser(model, parameters)


def caution_about(strategy: str, recogniser: Recogniser) -> str | None:
    """Return a warning if the model did not learn from touches by a strategy, otherwise None.

    Draws of a random strategy, such as ``random#2``, count as the strategy.
    """
    if recogniser.model.matching_strategy(strategy) is not None:
        return None
    touched = "at given points" if strategy == GIVEN else f"by {strategy}"
    return (
        f"The model learnt from touches by {' and '.join(recogniser.model.strategies)} and these touches were "
        f"made {touched}, so its probabilities are not calibrated for them and it states no prediction set."
    )


def set_phrase(candidates: Sequence[str] | None, coverage: float | None) -> str | None:
    """Return a prediction set with its coverage in words; None without a set."""
    if candidates is None or coverage is None:
        return None
    share = f"at least {100 * coverage:g} % of objects like the known ones"
    return f"one of: {', '.join(candidates)} (right for {share})"


def novelty_phrase(novelty_rank: float | None, compared: int | None) -> str | None:
    """Return in words how many of `compared` known objects are less novel than an object; None without scores."""
    if novelty_rank is None or compared is None:
        return None
    return f"farther out than {_less_novel(novelty_rank, compared)} of {compared} known objects"


def note_on_few_objects(answer: ModelAnswer) -> str | None:
    """Return a sentence that a model knows too few objects to call one unknown; None if it knows enough, or no scores."""
    from visuohaptic.recognition.parameters import least_known_objects

    compared, novelty_rank, coverage = answer.compared, answer.novelty_rank, answer.coverage
    if answer.unknown is not None or compared is None or novelty_rank is None or coverage is None:
        return None
    less_novel = _less_novel(novelty_rank, compared)
    distance = (
        "all of them, so it may be of another class"
        if less_novel == compared
        else f"{less_novel} of them"
    )
    return (
        f"{compared} known objects are too few to call an object unknown ({least_known_objects(coverage)} are needed); "
        f"this one lies farther out than {distance}."
    )


def _less_novel(novelty_rank: float, compared: int) -> int:
    return round(novelty_rank * (compared + 1))


def check_acquired(features: pa.Table, parameters: ExperimentParameters) -> None:
    """Raise `RecognitionError` if the sensor could reach no location of `features`, rows of `tables.FEATURES`.

    Nothing is checked for a sensor of fixed size (`parameters.scene.effects.adaptive_size` is ``never``).
    """
    from visuohaptic.tables.phases import OUT_OF_REACH

    # A sensor of fixed size may have the contact states of OUT_OF_REACH at locations in reach, too.
    if parameters.scene.effects.adaptive_size == "never" or not features.num_rows:
        return
    if set(features.column("contact_state").unique().to_pylist()) <= {*OUT_OF_REACH}:
        raise RecognitionError(
            f"The sensor could reach none of the {features.num_rows} locations that were touched; at least one "
            "touch in reach is needed."
        )


def check_compatible(touched: ExperimentParameters, recogniser: Recogniser) -> None:
    """Raise `RecognitionError` if a model can't classify touches with the parameters `touched`.

    The parameters of `touching_sections` must equal those of the model's training touches. Numbers of viewpoints and
    of touches may differ; the object's radius, too, if neither sensor has a cover. If `touched` sets
    `recognition.frame`, it must be the frame of the model.
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
    # Without a cover, imprints do not depend on the object's real size.
    may_differ = (*_MAY_DIFFER, "scene.object_radius_m") if covers == {"none"} else _MAY_DIFFER
    different = [
        name for name in names if here.get(name) != there.get(name) and name not in may_differ
    ]
    if different:
        listed = ", ".join(
            f"{name} {here.get(name)} (the model's is {there.get(name)})" for name in different
        )
        raise RecognitionError(
            f"The object was touched with {listed}; touch it with the parameters of the model."
        )


def _check_frame(touched: ExperimentParameters, recogniser: Recogniser) -> None:
    """Raise `RecognitionError` if the caller set a `recognition.frame` other than that of the model."""
    # A frame at its default was not chosen by the caller, so that it fits models of all frames.
    if "frame" not in touched.recognition.model_fields_set:
        return
    here, there = touched.recognition.frame, recogniser.model.parameters.frame
    if here != there:
        raise RecognitionError(
            f"recognition.frame is {here}, and the model was fitted for {there}; set {there}, or "
            f"fit a model with recognition.frame {here}."
        )


def touching_sections() -> set[str]:
    """Return the sections of parameters that `check_compatible` compares: those of views, touches and features."""
    from visuohaptic.phases import OF_OBJECT

    sections = {name.partition(".")[0] for phase in OF_OBJECT for name in phase.sections()}
    return sections - {"seed", "probing"}
