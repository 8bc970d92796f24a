"""The pipelines of recognition as unfitted scikit-learn parts, and class probabilities of fitted classifiers."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from sklearn.calibration import CalibratedClassifierCV
from sklearn.decomposition import PCA
from sklearn.neural_network import MLPClassifier
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.classifiers import CLASSIFIERS, Classifier
from visuohaptic.recognition.descriptors import describe_all, draw_waves
from visuohaptic.recognition.encoding import SequenceEncoder
from visuohaptic.recognition.parameters import TOUCH_NETWORK, RecognitionParameters
from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.recognition.splits import held_out_folds
from visuohaptic.recognition.touch_network import (
    TouchNetwork,
    TouchPreparation,
    learned_rows,
    learns_pairs,
)

logger = logging.getLogger(__name__)

ORDER_FREE_SETTINGS = ClassifierParameters(
    neighbours=15,
    svm_penalty=10.0,
    tree_leaf_sequences=8,
    discriminant_shrinkage=0.9,
    discriminant_regularisation="always",
    discriminant_target="mean_variance",
    bayes_smoothing=0.01,
    linear_shrinkage=0.1,
    logistic_penalty=0.03,
)
"""Settings of pipeline `order_free`, chosen on 67 objects outside the paper's set (studies/classifier_settings)."""

CALIBRATION_FOLDS = 2
"""Folds of training objects that fit the temperature: in the paper's set two objects of a class train."""

LEAST_LOG_PROBABILITY = -60.0
"""Log probability of a class without training objects, and the least of any class."""


class RecognitionPipeline(Protocol):
    """Interface of pipelines from sequences to predictions."""

    @property
    def name(self) -> str:
        """Name in parameters and tables."""

    @property
    def preparation(self) -> Any:
        """Unfitted transformer of rows; fitted once per split."""

    @property
    def classifiers(self) -> Mapping[str, Any]:
        """Unfitted classifiers of prepared rows, by name."""

    def rows(self, sequences: TouchSequences) -> Any:
        """Return the input of `preparation`, an array with one row per sequence; nothing is fitted."""

    def seeds(self, generator: np.random.Generator) -> dict[str, int]:
        """Return the seed of each classifier's fit."""

    def log_probabilities(self, fitted: Any, rows: Any, classes: int) -> FloatArray | None:
        """Return the log probability of each class, (n, classes), if the pipeline has probabilities."""


@dataclass(frozen=True)
class PaperPipeline:
    """The paper's pipeline: 60 features of a sequence, classifiers without probabilities."""

    preparation: SequenceEncoder
    classifiers: Mapping[str, Any]
    name: str = "paper"

    @classmethod
    def of(
        cls, parameters: RecognitionParameters, entries: Mapping[str, Classifier] | None = None
    ) -> PaperPipeline:
        """Return the pipeline of some parameters; `entries` replace the classifiers that the parameters name."""
        entries = entries or {name: CLASSIFIERS[name] for name in parameters.classifiers}
        classifiers = {name: entry.make(parameters.classifier) for name, entry in entries.items()}
        return cls(SequenceEncoder(parameters), classifiers)

    def rows(self, sequences: TouchSequences) -> FloatArray:
        """Return the features of all touches: (s, t, k)."""
        return sequences.features

    def seeds(self, generator: np.random.Generator) -> dict[str, int]:
        """Draw one seed per classifier, whether the classifier uses the seed or not."""
        return {name: int(generator.integers(2**31)) for name in self.classifiers}

    def log_probabilities(self, fitted: Any, rows: FloatArray, classes: int) -> FloatArray | None:  # noqa: ARG002
        """Return None: the paper's objects are classified by the majority of their sequences."""
        return None


@dataclass(frozen=True)
class OrderFreePipeline:
    """Our pipeline: descriptors that do not depend on the order of touches, classifiers with probabilities."""

    parameters: RecognitionParameters
    seed: int
    preparation: Pipeline
    classifiers: Mapping[str, Any]
    name: str = "order_free"

    @classmethod
    def of(cls, parameters: RecognitionParameters, seed: int) -> OrderFreePipeline:
        """Return the pipeline of some parameters; `seed` draws the waves of the descriptors."""
        steps = {name: make_order_free(name) for name in parameters.order_free.classifiers}
        classifiers = {name: pipeline[-1] for name, pipeline in steps.items()}
        return cls(parameters, seed, next(iter(steps.values()))[:-1], classifiers)

    def rows(self, sequences: TouchSequences) -> FloatArray:
        """Compute the descriptors of sequences: (s, d).

        Raises `RecognitionError` if no descriptor varies over several sequences, such as for the pose of a single touch in frame ``none``.
        """
        rows = describe_all(sequences, self.parameters, self.seed)
        if len(rows) > 1 and not np.ptp(rows, axis=0).any():
            raise RecognitionError(
                f"Every descriptor of the cues {', '.join(self.parameters.order_free.cues)} has the same value in all "
                f"sequences (frame {self.parameters.frame}, touches per sequence: {sequences.features.shape[1]}); at least one descriptor that "
                "varies is needed to distinguish classes."
            )
        return rows

    def seeds(self, generator: np.random.Generator) -> dict[str, int]:
        """Return an independent seed per classifier."""
        seed = int(generator.integers(2**31))
        return {name: int(spawn_generator(seed, name).integers(2**31)) for name in self.classifiers}

    def log_probabilities(self, fitted: Any, rows: FloatArray, classes: int) -> FloatArray:
        """Return log probabilities: (n, d) to (n, classes), `LEAST_LOG_PROBABILITY` for classes without training."""
        return log_probabilities(fitted, rows, classes)


@dataclass(frozen=True)
class LearnedPipeline:
    """Our pipeline with a network of touches or of pairs of touches, beside the discriminant of `order_free`."""

    parameters: RecognitionParameters
    seed: int
    preparation: TouchPreparation
    classifiers: Mapping[str, Any]
    name: str = "learned"

    @classmethod
    def of(cls, parameters: RecognitionParameters, seed: int) -> LearnedPipeline:
        """Return the pipeline of some parameters; `seed` draws the waves of the descriptors and of pairs."""
        learned = parameters.learned
        has_pairs = learns_pairs(parameters.frame, parameters.touches)
        passes = learned.pair_passes if has_pairs else learned.passes
        network = MLPClassifier((learned.units,), max_iter=passes)
        order_free = make_order_free()
        classifier = TouchNetwork(network, order_free[-1], learned.discriminant_weight)
        preparation = TouchPreparation(order_free[:-1])
        return cls(parameters, seed, preparation, {TOUCH_NETWORK: classifier})

    def rows(self, sequences: TouchSequences) -> NDArray[np.void]:
        """Compute the descriptors and the elements of sequences: (s,), by `learned_rows`."""
        waves = draw_waves(self.parameters.order_free, self.seed)
        return learned_rows(sequences.features, sequences.feature_names, waves, self.parameters)

    def seeds(self, generator: np.random.Generator) -> dict[str, int]:
        """Return the seed of the network's fit."""
        return {name: int(generator.integers(2**31)) for name in self.classifiers}

    def log_probabilities(self, fitted: Any, rows: Any, classes: int) -> FloatArray:
        """Return log probabilities: (n,) to (n, classes), `LEAST_LOG_PROBABILITY` for classes without training."""
        return log_probabilities(fitted, rows, classes)


def make_order_free(classifier: str = "linear_discriminant") -> Pipeline:
    """Return an unfitted scikit-learn pipeline for descriptors, such as `touch_descriptors` computes.

    `classifier` is a name of `CLASSIFIERS`. Raises `RegistryError` for other names.
    """
    return Pipeline(
        [
            ("scaling", StandardScaler()),
            # A rotation to at most as many columns as rows: distances stay, and fits of few sequences are quick.
            ("rotation", PCA(1 - 1e-9, svd_solver="full")),
            ("classifier", CLASSIFIERS[classifier].make(ORDER_FREE_SETTINGS)),
        ]
    )


def fit_preparation(preparation: Any, rows: Any) -> Any:
    """Fit a preparation on rows of training sequences, and return these rows as its `transform` prepares them."""
    if isinstance(preparation, SequenceEncoder):
        return preparation.fit_transform(rows)
    # The `fit_transform` of scikit-learn's rotation has other bits than its `transform`.
    return preparation.fit(rows).transform(rows)


def fit_calibrated(classifier: Any, rows: FloatArray, labels: IntArray, owners: IntArray) -> Any:
    """Fit a classifier on rows (n, d) of classes and objects (n,), with a temperature for its probabilities.

    The temperature is fitted on training objects that copies of the classifier did not learn (C. Guo et al., "On
    calibration of modern neural networks", ICML 2017). If a class has one object, or no temperature is found, the
    classifier has none.
    """
    folds = held_out_folds(labels, owners, CALIBRATION_FOLDS)
    if sum(len(held_out) for _, held_out in folds) < len(rows):
        return classifier.fit(rows, labels)
    calibrated = CalibratedClassifierCV(classifier, method="temperature", cv=folds, ensemble=False)
    try:
        return calibrated.fit(rows, labels)
    except RuntimeError as error:  # scores so far apart that their exponentials overflow
        logger.warning("%s has no temperature: %s", type(classifier).__name__, error)
        return classifier.fit(rows, labels)


def pipeline_of(name: str, parameters: RecognitionParameters, seed: int) -> RecognitionPipeline:
    """Return pipeline ``paper``, ``order_free`` or ``learned``. Raises `RecognitionError` for other names."""
    if name == "paper":
        return PaperPipeline.of(parameters)
    if name == "order_free":
        return OrderFreePipeline.of(parameters, seed)
    if name == "learned":
        return LearnedPipeline.of(parameters, seed)
    raise RecognitionError(
        f"There is no pipeline {name}; paper, order_free and learned are allowed."
    )


def log_probabilities(fitted: Any, rows: Any, classes: int) -> FloatArray:
    """Compute log probabilities of a fitted classifier whose classes are numbers below `classes`: (n, classes)."""
    if hasattr(fitted, "predict_proba"):
        with np.errstate(divide="ignore"):  # a leaf of a tree may hold one class only
            logs = np.log(fitted.predict_proba(rows))
    else:
        scores = fitted.decision_function(rows)
        scores = np.column_stack([-scores, scores]) if scores.ndim == 1 else scores
        logs = scores - np.logaddexp.reduce(scores, axis=1, keepdims=True)
    filled = np.full((len(rows), classes), LEAST_LOG_PROBABILITY)
    filled[:, fitted.classes_] = np.maximum(logs, LEAST_LOG_PROBABILITY)
    return filled


def pooled_log_probabilities(logs: FloatArray, members: Any) -> FloatArray:
    """Compute the log probabilities of groups of sequences by the mean over their sequences.

    Parameters
    ----------
    logs : ndarray of shape (n, c)
        Log probabilities of sequences.
    members : ndarray of shape (m, n), bool
        The sequences of each group.

    Returns
    -------
    ndarray of shape (m, c)
        Normalised means. The mean replaces the sum because views of one object make similar errors.
    """
    means = members.astype(np.float64) @ logs / members.sum(axis=1, keepdims=True)
    normalised: FloatArray = means - np.logaddexp.reduce(means, axis=1, keepdims=True)
    return normalised
