"""A trained recogniser, fitted on the objects at hand."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic import __version__
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError, TableError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.certainty import (
    Calibration,
    SequenceClassifier,
    fit_calibration,
    one_classifier,
)
from visuohaptic.recognition.classifiers import ClassifierName, fit_classifier
from visuohaptic.recognition.descriptors import WaveBasis, describe_sequences, draw_waves
from visuohaptic.recognition.encoding import SequenceEncoder, fit_sequence_encoder
from visuohaptic.recognition.experiment import gather_pipeline
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import pool_answers
from visuohaptic.recognition.sequences import (
    TouchSequences,
    first_touches,
    gather_any,
    spread_contact_states,
)
from visuohaptic.recognition.short_sequences import ShortClassifier, fit_short_classifiers
from visuohaptic.recognition.splits import check_two_classes
from visuohaptic.recognition.tuning import Projection, TunedClassifier, fit_best_classifiers
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import known_columns


@dataclass(frozen=True)
class SequenceDescriber:
    """Pipeline `best` up to the classifier: descriptors of fixed waves, then a fitted projection."""

    waves: WaveBasis
    names: tuple[str, ...]
    parameters: BestParameters
    projection: Projection

    def encode(self, sequences: FloatArray) -> FloatArray:
        """Give what the classifier sees: (s, t, k) to (s, q)."""
        return self.projection.apply(self.describe(sequences))

    def describe(self, sequences: FloatArray) -> FloatArray:
        """Describe them alone: (s, t, k) to (s, d)."""
        return describe_sequences(sequences, self.names, self.waves, self.parameters)


@dataclass(frozen=True)
class _Part:
    """Sequences (n, p) of an object for one classifier, and their touches (m, k)."""

    classifier: SequenceClassifier
    calibration: Calibration | None
    encoded: FloatArray
    touches: FloatArray

    def answer(self) -> FloatArray:
        everything = np.ones((1, len(self.encoded)), dtype=bool)
        return self.classifier.ballots(self.encoded).together(everything)[0]


@dataclass(frozen=True)
class ModelAnswer:
    """What a model says of one object, the likeliest class first; the rest is `certainty.Certainty`'s.

    Without a calibration all but `probabilities` is None.
    """

    probabilities: dict[str, float]
    candidates: tuple[str, ...] | None = None
    strangeness: float | None = None
    unknown: bool | None = None
    coverage: float | None = None


@dataclass(frozen=True)
class RecognitionModel:
    """Everything needed to classify an object from its touches.

    `objects` are those that it learnt, as (class, name), and `touches` those of a sequence.
    `calibration` is None in pipeline `paper`, and where no class has a second object. `short` holds
    what classifies sequences of fewer touches, by their number. `touching` is JSON: the parameters
    with which its touches were made, where they are known.
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
    touching: str | None = None

    def recognise(self, features: pa.Table) -> dict[str, float]:
        """Give one object's class probabilities, the likeliest first, from all its touches together.

        `features` has rows of `tables.FEATURES` of one object and strategy, however many. A
        viewpoint with more touches than the model's sequences have counts as several sequences; one
        with fewer as a short one. Raises `RecognitionError` if the table lacks a feature, or there
        is no touch, or, in pipeline `paper`, no viewpoint has as many touches as the model needs.
        """
        return self.answer(features).probabilities

    def answer(self, features: pa.Table) -> ModelAnswer:
        """Classify one object as `recognise` does, and say how sure that is."""
        try:
            features = known_columns(FEATURES, features)
        except TableError as error:
            raise RecognitionError(f"The features can't be used: {error}") from error
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

    def check(self) -> None:
        """Predict a sequence of zeros: raises `ValueError` if the parts don't belong together."""
        zeros = np.zeros((1, self.touches, len(self.feature_names)))
        for length in (*self.short, self.touches):
            found = self._part(length, [zeros[:, :length]]).answer()
            if found.shape != (len(self.classes),) or not np.isfinite(found).all():
                raise ValueError(f"no probabilities of {len(self.classes)} classes")

    def _parts(self, features: pa.Table) -> list[_Part]:
        by_length: dict[int, list[FloatArray]] = {}
        for sequences in self._sequences(features):
            length = self._length_for(sequences.shape[1])
            by_length.setdefault(length, []).append(sequences)
        return [self._part(length, found) for length, found in by_length.items()]

    def _length_for(self, touches: int) -> int:
        """Give the length, of those that the model learnt, that is most like so many touches."""
        lengths = (*self.short, self.touches)
        return min(lengths, key=lambda length: max(length, touches) / min(length, touches))

    def _part(self, length: int, sequences: list[FloatArray]) -> _Part:
        touches = np.concatenate([part.reshape(-1, part.shape[2]) for part in sequences])
        if length in self.short and isinstance(self.encoder, SequenceDescriber):
            short = self.short[length]
            rows = np.concatenate([self.encoder.describe(part) for part in sequences])
            return _Part(short, short.calibration, short.encode(rows), touches)
        encoded = np.concatenate([self.encoder.encode(part) for part in sequences])
        return _Part(self.tuned, self.calibration, encoded, touches)

    def _sequences(self, features: pa.Table) -> list[FloatArray]:
        """Give all sequences of one object, shape (s, t, k) for each length t."""
        if not features.num_rows:
            raise RecognitionError("There is no touch; an object is classified from one touch on.")
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
    """Train pipeline ``paper`` or ``best`` on every object of a table of features of one strategy.

    Raises `RecognitionError` if the features don't allow it.
    """
    from threadpoolctl import threadpool_limits

    sequences = gather_pipeline(features, parameters, pipeline, seed)
    check_two_classes(sequences)
    fit = {"paper": _fit_paper, "best": _fit_best}[pipeline]
    with threadpool_limits(limits=1):
        fitted = fit(sequences, classifier, parameters, seed)
    return RecognitionModel(
        pipeline=pipeline,
        strategy=features.column("strategy")[0].as_py(),
        classifier=classifier,
        classes=sequences.classes,
        feature_names=sequences.feature_names,
        touches=sequences.features.shape[1],
        objects=sequences.objects,
        parameters=parameters,
        versions={
            "visuohaptic": __version__,
            "python": platform.python_version(),
            **{name: version(name) for name in ("numpy", "scikit-learn", "pywavelets", "skops")},
        },
        **fitted,
    )


def _fit_paper(
    sequences: TouchSequences,
    classifier: ClassifierName,
    parameters: RecognitionParameters,
    seed: int,
) -> dict[str, Any]:
    generator = spawn_generator(seed, "recognition", "model", "paper")
    encoder = fit_sequence_encoder(sequences.features, parameters, generator)
    fitted, _ = fit_classifier(
        classifier,
        parameters.classifier,
        encoder.encode(sequences.features),
        sequences.labels,
        generator,
    )
    tuned = TunedClassifier(fitted, parameters.classifier, 1.0, len(sequences.classes), "")
    return {"encoder": encoder, "tuned": tuned}


def _fit_best(
    sequences: TouchSequences,
    classifier: ClassifierName,
    parameters: RecognitionParameters,
    seed: int,
) -> dict[str, Any]:
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
    return {"encoder": describer, "tuned": tuned, "calibration": calibration, "short": short}
