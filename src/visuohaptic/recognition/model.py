"""A trained recogniser: fitted on the objects at hand, saved so that loading runs no code."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic import __version__
from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.certainty import (
    Calibration,
    Landmarks,
    SequenceClassifier,
    fit_calibration,
    one_classifier,
)
from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.recognition.descriptors import (
    WaveBasis,
    describe_sequences,
    draw_waves,
)
from visuohaptic.recognition.encoding import (
    FeatureGroups,
    SequenceEncoder,
    Standardiser,
    fit_sequence_encoder,
)
from visuohaptic.recognition.experiment import gather_pipeline
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import BagClassifier, Combination, pool_answers
from visuohaptic.recognition.self_organising_map import SelfOrganisingMap
from visuohaptic.recognition.sequences import (
    TouchSequences,
    first_touches,
    gather_any,
    spread_contact_states,
)
from visuohaptic.recognition.set_distance import KnownTouches
from visuohaptic.recognition.short_sequences import ShortClassifier, fit_short_classifiers
from visuohaptic.recognition.splits import check_two_classes
from visuohaptic.recognition.tuning import Projection, TunedClassifier, fit_best_classifiers
from visuohaptic.seeds import spawn_generator
from visuohaptic.whole_files import whole_file

FORMAT = "visuohaptic recognition model 4"
OLDER_FORMATS = tuple(f"visuohaptic recognition model {number}" for number in (1, 2, 3))
"""Models without a classifier of bags; without touches to compare an object's with; without classifiers
of short sequences."""

LARGEST_BYTES = 2**30
"""A model file that unpacks to more is refused; one of 142 objects has some megabytes."""


@dataclass(frozen=True)
class SequenceDescriber:
    """Pipeline `best` up to the classifier: descriptors of fixed waves, then a fitted projection."""

    waves: WaveBasis
    names: tuple[str, ...]
    parameters: BestParameters
    projection: Projection

    def encode(self, sequences: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give what the classifier sees: (s, t, k) to (s, q)."""
        return self.projection.apply(self.describe(sequences))

    def describe(self, sequences: NDArray[np.float64]) -> NDArray[np.float64]:
        """Describe them alone: (s, t, k) to (s, d)."""
        return describe_sequences(sequences, self.names, self.waves, self.parameters)


@dataclass(frozen=True)
class _Part:
    """Sequences (n, p) of an object that one classifier names, and their touches (m, k)."""

    classifier: SequenceClassifier
    calibration: Calibration | None
    encoded: NDArray[np.float64]
    touches: NDArray[np.float64]

    def answer(self) -> NDArray[np.float64]:
        everything = np.ones((1, len(self.encoded)), dtype=bool)
        found: NDArray[np.float64] = self.classifier.ballots(self.encoded).together(everything)[0]
        return found


@dataclass(frozen=True)
class ModelAnswer:
    """What a model says of one object.

    Attributes
    ----------
    probabilities : dict of str to float
        Of each class, the likeliest first.
    candidates : tuple of str or None
        The prediction set, the likeliest first; None, as all that follows, without a calibration.
    strangeness : float or None
        Share of the training objects' kind that is less strange, between 0 and 1.
    unknown : bool or None
        Whether the object is of no class that the model knows.
    coverage : float or None
        The share of objects of known classes that the set and the word unknown are right about.
    """

    probabilities: dict[str, float]
    candidates: tuple[str, ...] | None = None
    strangeness: float | None = None
    unknown: bool | None = None
    coverage: float | None = None


@dataclass(frozen=True)
class RecognitionModel:
    """Everything needed to name an object from its touches.

    Attributes
    ----------
    pipeline, strategy, classifier : str
        How it works, and whose touches it learnt from.
    classes : tuple of str
        The c classes.
    feature_names : tuple of str
        The k numbers of a touch, in order.
    touches : int
        Touches a sequence.
    objects : tuple of (str, str)
        The objects it learnt, as (class, name).
    parameters : RecognitionParameters
        What it was trained with.
    versions : mapping of str to str
        Versions of the packages that trained it.
    encoder : SequenceEncoder or SequenceDescriber
        From touches to what the classifier sees.
    tuned : TunedClassifier
        The classifier.
    calibration : Calibration or None
        Training objects, each named without itself; None in pipeline `paper`, in models of the first
        format, and where no class has a second object.
    short : mapping of int to ShortClassifier
        What names sequences of fewer touches, by their number; empty where none was wanted.
    """

    pipeline: str
    strategy: str
    classifier: ClassifierName
    classes: tuple[str, ...]
    feature_names: tuple[str, ...]
    touches: int
    objects: tuple[tuple[str, str], ...]
    parameters: RecognitionParameters
    versions: Mapping[str, str]
    encoder: SequenceEncoder | SequenceDescriber
    tuned: TunedClassifier
    calibration: Calibration | None = None
    short: Mapping[int, ShortClassifier] = field(default_factory=dict)

    def recognise(self, features: pa.Table) -> dict[str, float]:
        """Name one object from all its touches together, however many there are.

        A viewpoint with more touches than the model's sequences have counts as several sequences; one
        with fewer as a short one.

        Parameters
        ----------
        features : pyarrow.Table
            Rows of `tables.FEATURES` of one object and strategy.

        Returns
        -------
        dict of str to float
            Probability of each class, the likeliest first.

        Raises
        ------
        RecognitionError
            If the table lacks a feature, or there is no touch, or, in pipeline `paper`, no viewpoint
            has as many touches as the model needs.
        """
        return self.answer(features).probabilities

    def answer(self, features: pa.Table) -> ModelAnswer:
        """Name one object from all its touches together, and say how sure that is.

        Takes and raises what `recognise` does.
        """
        parts = self._parts(features)
        found = pool_answers(
            [part.answer() for part in parts], [len(part.touches) for part in parts]
        )
        order = np.argsort(-found, kind="stable")
        probabilities = {self.classes[place]: float(found[place]) for place in order}
        # Training objects are known by the first touches of a view alone.
        first = first_touches(features, self.touches)
        if first.num_rows < features.num_rows:
            parts = self._parts(first)
        most = max(parts, key=lambda part: len(part.touches))
        if most.calibration is None:
            return ModelAnswer(probabilities)
        coverage = self.parameters.best.coverage
        certainty = most.calibration.assess(
            most.classifier, most.encoded, most.touches, found, coverage
        )
        return ModelAnswer(
            probabilities,
            tuple(self.classes[place] for place in order if certainty.candidates[place]),
            certainty.strangeness,
            certainty.unknown,
            coverage,
        )

    def _parts(self, features: pa.Table) -> list[_Part]:
        by_length: dict[int, list[NDArray[np.float64]]] = {}
        for sequences in self._sequences(features):
            length = self._named_as(sequences.shape[1])
            by_length.setdefault(length, []).append(sequences)
        return [self._part(length, found) for length, found in by_length.items()]

    def _named_as(self, touches: int) -> int:
        """Give the length, of those that the model learnt, that is most like so many touches."""
        ratios = {length: max(length, touches) / min(length, touches) for length in self.short}
        ratios[self.touches] = max(self.touches, touches) / min(self.touches, touches)
        return min(ratios, key=lambda length: ratios[length])

    def _part(self, length: int, sequences: list[NDArray[np.float64]]) -> _Part:
        touches = np.concatenate([part.reshape(-1, part.shape[2]) for part in sequences])
        if length in self.short and isinstance(self.encoder, SequenceDescriber):
            short = self.short[length]
            rows = np.concatenate([self.encoder.describe(part) for part in sequences])
            return _Part(short, short.calibration, short.encode(rows), touches)
        encoded = np.concatenate([self.encoder.encode(part) for part in sequences])
        return _Part(self.tuned, self.calibration, encoded, touches)

    def _sequences(self, features: pa.Table) -> list[NDArray[np.float64]]:
        """Give all sequences of one object, shape (s, t, k) for each length t."""
        if not features.num_rows:
            raise RecognitionError("There is no touch; an object is named from one touch on.")
        parts = gather_any(spread_contact_states(features), self.feature_names, self.touches)
        if self.pipeline == "paper":  # its wavelet needs whole sequences
            parts = [part for part in parts if part.shape[1] == self.touches]
        if self.parameters.order == "shuffled":
            order = spawn_generator(0, "order")
            parts = [np.stack([order.permutation(one) for one in part]) for part in parts]
        if not parts:
            raise RecognitionError(
                f"No viewpoint has {self.touches} touches, which the model needs: the object is too "
                "slender in all views."
            )
        return parts


def fit_model(
    features: pa.Table,
    pipeline: str,
    classifier: ClassifierName,
    parameters: RecognitionParameters,
    seed: int,
) -> RecognitionModel:
    """Train on every object of a table.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES` of one strategy.
    pipeline : str
        ``paper`` or ``best``.
    classifier : str
        One classifier.
    parameters : RecognitionParameters
        Every choice that is not made inside.
    seed : int
        The experiment's seed.

    Returns
    -------
    RecognitionModel
        The model.

    Raises
    ------
    RecognitionError
        If the features don't allow it.
    """
    from threadpoolctl import threadpool_limits

    sequences = gather_pipeline(features, parameters, pipeline, seed)
    check_two_classes(sequences)
    fitters: dict[str, Callable[..., _Fit]] = {
        "paper": _fit_paper,
        "best": _fit_best,
    }
    with threadpool_limits(limits=1):
        fit = fitters[pipeline](sequences, classifier, parameters, seed)
    return RecognitionModel(
        pipeline=pipeline,
        strategy=features.column("strategy")[0].as_py(),
        classifier=classifier,
        classes=sequences.classes,
        feature_names=sequences.feature_names,
        touches=sequences.features.shape[1],
        objects=sequences.objects,
        parameters=parameters,
        versions=_versions(),
        encoder=fit.encoder,
        tuned=fit.tuned,
        calibration=fit.calibration,
        short=fit.short,
    )


def save_model(model: RecognitionModel, path: str | Path) -> None:
    """Write a model with skops, whole or not at all.

    Parameters
    ----------
    model : RecognitionModel
        The model.
    path : path
        The file, such as ``recogniser.skops``; its folder is made where missing.

    Raises
    ------
    RecognitionError
        If the classifier can't be saved so that loading is safe: scikit-learn follows
        a decision tree's stored indices unchecked.
    """
    import skops.io

    estimator = copy.copy(model.tuned.estimator)
    if getattr(estimator, "covariance_estimator", None) is not None:
        # Only training needs it, and without it the file holds scikit-learn's own types alone.
        estimator.covariance_estimator = None
    state = {
        "format": FORMAT,
        "pipeline": model.pipeline,
        "strategy": model.strategy,
        "classifier": model.classifier,
        "classes": list(model.classes),
        "feature_names": list(model.feature_names),
        "touches": model.touches,
        "objects": [list(owner) for owner in model.objects],
        "parameters": model.parameters.model_dump_json(),
        "versions": dict(model.versions),
        "encoder": _encoder_state(model.encoder),
        "estimator": estimator,
        "temperature": model.tuned.temperature,
        "setting": model.tuned.setting,
        "bags": _bags_state(model.tuned),
        "calibration": _calibration_state(model.calibration),
        "short": _short_state(model.short),
    }
    content = skops.io.dumps(state)
    unsafe = skops.io.get_untrusted_types(data=content)
    if unsafe:
        raise RecognitionError(
            f"A {model.classifier} can't be saved so that it is safe to load (it needs "
            f"{', '.join(unsafe)}); choose another classifier."
        )
    with whole_file(path) as unfinished:
        unfinished.write_bytes(content)


def load_model(path: str | Path) -> RecognitionModel:
    """Read a model; a file that would bring code of its own is refused.

    Parameters
    ----------
    path : path
        What `save_model` wrote.

    Returns
    -------
    RecognitionModel
        The model.

    Raises
    ------
    RecognitionError
        If the file can't be read, is larger than `LARGEST_BYTES`, holds other types than NumPy's and
        scikit-learn's, or is no whole model of this package.
    """
    import skops.io
    from skops.io.exceptions import UntrustedTypesFoundException

    try:
        _check_size(Path(path))
        state = skops.io.loads(Path(path).read_bytes(), trusted=None)
    except RecognitionError:
        raise
    except UntrustedTypesFoundException as error:
        raise RecognitionError(
            f"{path} holds types that a model has no need of, and is not loaded."
        ) from error
    except Exception as error:
        raise RecognitionError(
            f"{path} can't be read as a recognition model ({error}); train it again."
        ) from error
    if not isinstance(state, dict) or state.get("format") not in (FORMAT, *OLDER_FORMATS):
        raise RecognitionError(f"{path} is no {FORMAT!r}; train it again with this version.")
    try:
        return _model_of(state)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise RecognitionError(
            f"{path} lacks parts of a model ({error!r}); train it again."
        ) from error


def _check_size(path: Path) -> None:
    import zipfile

    with zipfile.ZipFile(path) as archive:
        unpacked = sum(part.file_size for part in archive.infolist())
    if unpacked > LARGEST_BYTES:
        raise RecognitionError(
            f"{path} unpacks to {unpacked / 1e6:.0f} MB; at most {LARGEST_BYTES / 1e6:.0f} MB are "
            "allowed."
        )


def _model_of(state: dict[str, Any]) -> RecognitionModel:
    parameters = RecognitionParameters.model_validate_json(state["parameters"])
    classes = tuple(state["classes"])
    names = tuple(state["feature_names"])
    bags, combination = _bags_of(state.get("bags"))
    return RecognitionModel(
        pipeline=state["pipeline"],
        strategy=state["strategy"],
        classifier=state["classifier"],
        classes=classes,
        feature_names=names,
        touches=state["touches"],
        objects=tuple((category, name) for category, name in state["objects"]),
        parameters=parameters,
        versions=state["versions"],
        encoder=_encoder_of(state["encoder"], names, parameters),
        tuned=TunedClassifier(
            state["estimator"],
            state["temperature"],
            len(classes),
            state["setting"],
            bags,
            combination,
        ),
        calibration=_calibration_of(state.get("calibration")),
        short=_short_of(state.get("short"), len(classes)),
    )


@dataclass(frozen=True)
class _Fit:
    """What a pipeline fits, as in `RecognitionModel`."""

    encoder: SequenceEncoder | SequenceDescriber
    tuned: TunedClassifier
    calibration: Calibration | None = None
    short: Mapping[int, ShortClassifier] = field(default_factory=dict)


def _fit_paper(
    sequences: TouchSequences,
    classifier: ClassifierName,
    parameters: RecognitionParameters,
    seed: int,
) -> _Fit:
    from visuohaptic.recognition.classifiers import fit_classifier

    generator = spawn_generator(seed, "recognition", "model", "paper")
    encoder = fit_sequence_encoder(sequences.features, parameters, generator)
    fitted, _ = fit_classifier(
        classifier,
        parameters.classifier,
        encoder.encode(sequences.features),
        sequences.labels,
        generator,
    )
    return _Fit(encoder, TunedClassifier(fitted, 1.0, len(sequences.classes), ""))


def _fit_best(
    sequences: TouchSequences,
    classifier: ClassifierName,
    parameters: RecognitionParameters,
    seed: int,
) -> _Fit:
    generator = spawn_generator(seed, "recognition", "model", "best")
    waves = draw_waves(parameters.best, spawn_generator(seed, "recognition", "waves"))
    names = sequences.feature_names
    described = describe_sequences(sequences.features, names, waves, parameters.best)
    one = one_classifier(parameters, classifier)
    training = (sequences.labels, sequences.object_index, len(sequences.classes), one)
    projection, [(_, tuned, _)] = fit_best_classifiers(described, *training, generator)
    calibration = fit_calibration(sequences, described, one, projection, generator)
    touches = sequences.features
    first = [length for length in parameters.best.short_touches if length < touches.shape[1]]
    short = fit_short_classifiers(
        sequences,
        {
            length: describe_sequences(touches[:, :length], names, waves, parameters.best)
            for length in sorted(set(first))
        },
        parameters.best,
        spawn_generator(seed, "recognition", "model", "short"),
    )
    describer = SequenceDescriber(waves, names, parameters.best, projection)
    return _Fit(describer, tuned, calibration, short)


def _encoder_state(encoder: SequenceEncoder | SequenceDescriber) -> dict[str, Any]:
    if isinstance(encoder, SequenceDescriber):
        return {
            "directions": encoder.waves.directions,
            "phases": encoder.waves.phases,
            "mean": encoder.projection.scaling.mean,
            "scale": encoder.projection.scaling.scale,
            "components": encoder.projection.components,
        }
    reduction = encoder.reduction
    positions = reduction.positions if isinstance(reduction, SelfOrganisingMap) else None
    return {
        "touch_mean": encoder.touch_scaling.mean,
        "touch_scale": encoder.touch_scaling.scale,
        "weights": reduction.weights,
        "positions": positions,
        "mean": encoder.feature_scaling.mean,
        "scale": encoder.feature_scaling.scale,
    }


def _encoder_of(
    state: dict[str, Any], names: tuple[str, ...], parameters: RecognitionParameters
) -> SequenceEncoder | SequenceDescriber:
    scaling = Standardiser(state["mean"], state["scale"])
    if "directions" in state:
        waves = WaveBasis(state["directions"], state["phases"])
        projection = Projection(scaling, state["components"])
        return SequenceDescriber(waves, names, parameters.best, projection)
    weights, positions = state["weights"], state["positions"]
    reduction: SelfOrganisingMap | FeatureGroups = (
        FeatureGroups(weights) if positions is None else SelfOrganisingMap(weights, positions)
    )
    return SequenceEncoder(
        Standardiser(state["touch_mean"], state["touch_scale"]),
        reduction,
        parameters.self_organising_map,
        parameters.sequence,
        scaling,
    )


def _bags_state(tuned: TunedClassifier) -> dict[str, Any] | None:
    if tuned.bags is None or tuned.combination is None:
        return None
    return {**_discriminant_state(tuned.bags), **_combination_state(tuned.combination)}


def _bags_of(state: dict[str, Any] | None) -> tuple[BagClassifier | None, Combination | None]:
    if state is None:
        return None, None
    return _discriminant_of(state), _combination_of(state)


def _discriminant_state(bags: BagClassifier) -> dict[str, Any]:
    names = ("coefficients", "intercepts", "trained")
    return {name: getattr(bags, name) for name in names}


def _discriminant_of(state: dict[str, Any]) -> BagClassifier:
    return BagClassifier(state["coefficients"], state["intercepts"], state["trained"])


def _combination_state(combination: Combination) -> dict[str, Any]:
    names = ("views", "temperatures", "known")
    arrays = {name: getattr(combination, name) for name in names}
    return {"scales": list(combination.scales), **arrays}


def _combination_of(state: dict[str, Any]) -> Combination:
    first, second = state["scales"]
    return Combination((first, second), state["views"], state["temperatures"], state["known"])


def _short_state(short: Mapping[int, ShortClassifier]) -> dict[str, Any] | None:
    if not short:
        return None
    one = next(iter(short.values()))
    return {
        "scaling": [one.projection.scaling.mean, one.projection.scaling.scale],
        "components": one.projection.components,
        "bags": _discriminant_state(one.bags),
        "lengths": [
            {
                "touches": touches,
                "scaling": [classifier.scaling.mean, classifier.scaling.scale],
                "combination": _combination_state(classifier.combination),
                "calibration": _calibration_state(classifier.calibration),
            }
            for touches, classifier in short.items()
        ],
    }


def _short_of(state: dict[str, Any] | None, classes: int) -> dict[int, ShortClassifier]:
    if state is None:
        return {}
    projection = Projection(Standardiser(*state["scaling"]), state["components"])
    bags = _discriminant_of(state["bags"])
    return {
        part["touches"]: ShortClassifier(
            Standardiser(*part["scaling"]),
            projection,
            bags,
            classes,
            _combination_of(part["combination"]),
            _calibration_of(part["calibration"]),
        )
        for part in state["lengths"]
    }


def _calibration_state(calibration: Calibration | None) -> dict[str, Any] | None:
    if calibration is None:
        return None
    return {
        "views": calibration.views,
        "labels": calibration.labels,
        "misfits": calibration.nonconformity,  # its name in the file's format
        "evidence": calibration.evidence,
        "landmarks": calibration.landmarks.objects,
        "touches": _touches_state(calibration.landmarks.touches),
    }


def _calibration_of(state: dict[str, Any] | None) -> Calibration | None:
    if state is None:
        return None
    touches = state.get("touches")
    landmarks = Landmarks(state["landmarks"], None if touches is None else KnownTouches(**touches))
    return Calibration(
        state["views"], state["labels"], state["misfits"], state["evidence"], landmarks
    )


def _touches_state(touches: KnownTouches | None) -> dict[str, Any] | None:
    if touches is None:
        return None
    return {"weights": touches.weights, "touches": touches.touches, "starts": touches.starts}


def _versions() -> dict[str, str]:
    import platform
    from importlib.metadata import version

    packages = ("numpy", "scikit-learn", "pywavelets", "skops")
    return {
        "visuohaptic": __version__,
        "python": platform.python_version(),
        **{name: version(name) for name in packages},
    }
