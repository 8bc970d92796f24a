"""Fit a recognition model on all objects of a table, and classify an object by the model."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from importlib.metadata import version
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from sklearn.base import clone
from sklearn.pipeline import Pipeline

from visuohaptic import __version__
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.draw_names import draw_of
from visuohaptic.base.errors import RecognitionError, TableError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.certainty import FOLDS, Certainty, fit_certainty
from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.recognition.descriptors import describe_sequences, draw_waves
from visuohaptic.recognition.experiment import one_thread, seeded
from visuohaptic.recognition.frames import WaveBasis
from visuohaptic.recognition.parameters import (
    ROLLING_FRAMES,
    RecognitionParameters,
    least_known_objects,
)
from visuohaptic.recognition.pipelines import (
    RecognitionPipeline,
    fit_calibrated,
    fit_preparation,
    log_probabilities,
    pipeline_of,
    pooled_log_probabilities,
)
from visuohaptic.recognition.roll_free import check_directions
from visuohaptic.recognition.sequences import (
    filled_bands,
    first_touches,
    gather_any,
    gather_pipeline,
    join_sequences,
    spread_contact_states,
)
from visuohaptic.recognition.splits import check_two_classes
from visuohaptic.recognition.touch_network import descriptors_of, learned_rows, learns_pairs
from visuohaptic.tables.phases import CONTOURLET_FEATURES, FEATURES
from visuohaptic.tables.schema import known_columns


@dataclass(frozen=True)
class ModelAnswer:
    """Answer of a model for one object.

    The optional attributes are as in `exploration.exploring.Recognition`. All are None if
    `RecognitionModel.certainties` has no entry for the strategy of the touches. `unknown` is also None if `compared` is
    below `parameters.least_known_objects`.

    Attributes
    ----------
    probabilities : dict of str to float
        Probability of each class, the likeliest class first. In pipeline ``paper``, the share of the object's
        sequences that were classified as the class.
    """

    probabilities: dict[str, float]
    candidates: tuple[str, ...] | None = None
    novelty_rank: float | None = None
    unknown: bool | None = None
    coverage: float | None = None
    compared: int | None = None


@dataclass(frozen=True)
class RecognitionModel:
    """Everything that is needed to classify an object from its touches.

    Attributes
    ----------
    pipeline, classifier : str
        Pipeline and classifier of the fit.
    strategies : tuple of str
        Strategies of the training touches.
    classes, feature_names : tuple of str
        Sorted classes; names of the k features of a touch, in the order of the model's input.
    touches : int
        Number of touches per sequence.
    objects : tuple of (class, name)
        Training objects.
    parameters : RecognitionParameters
        Settings of the fit.
    versions : mapping of str to str
        Versions of the packages that fitted the model.
    estimator : sklearn.pipeline.Pipeline
        Fitted on descriptors (``order_free``), sequences (``paper``), or rows of `learned_rows` (``learned``).
    waves : WaveBasis, optional
        Random waves of the descriptors; None in pipeline ``paper``.
    certainties : mapping of str to Certainty
        Scores of the held-out training objects per strategy of `strategies`. A strategy without such objects has no
        entry. Empty in pipeline ``paper``.
    touching : str, optional
        JSON of the experiment parameters that made the training touches; None if unknown, as after `fit_model`.
    """

    pipeline: str
    strategies: tuple[str, ...]
    classifier: ClassifierName
    classes: tuple[str, ...]
    feature_names: tuple[str, ...]
    touches: int
    objects: tuple[tuple[str, str], ...]
    parameters: RecognitionParameters
    versions: Mapping[str, str]
    estimator: Pipeline
    waves: WaveBasis | None = None
    certainties: Mapping[str, Certainty] = field(default_factory=dict)
    touching: str | None = None

    @property
    def uses_azimuth(self) -> bool:
        """Whether probabilities can change if an object is turned about the vertical."""
        return self.pipeline == "paper" or self.parameters.frame == "full"

    def recognise(self, features: pa.Table) -> dict[str, float]:
        """Return the probability of each class for one object, the likeliest class first.

        Parameters
        ----------
        features : pyarrow.Table
            Rows of `tables.FEATURES` of one object and strategy. All touches are used. A viewpoint with more than
            `touches` touches gives several sequences; the last may overlap the sequence before. A viewpoint with fewer
            gives a shorter sequence, and is left out in pipeline ``paper``.

        Returns
        -------
        dict of str to float
            `ModelAnswer.probabilities`.

        Raises
        ------
        RecognitionError
            If the table has no touch, lacks a column, has touches of several objects or strategies, or a value that is
            not finite. In pipeline ``paper`` also if no viewpoint has `touches` touches.
        """
        return self.answer(features).probabilities

    def answer(self, features: pa.Table) -> ModelAnswer:
        """Return class probabilities and prediction set of one object, and whether the object seems unknown.

        Parameters and errors are those of `recognise`. The coverage is `parameters.order_free.coverage`. If
        `certainties` has no entry for `matching_strategy` of the touches, the answer has only probabilities.
        """
        try:
            features = known_columns(FEATURES, features)
        except TableError as error:
            raise RecognitionError(f"The features can't be used: {error}") from error
        logs = self._pooled_logs(self._rows(features))
        order = np.argsort(-logs, kind="stable")
        probabilities = {self.classes[index]: float(np.exp(logs[index])) for index in order}
        strategy = self.matching_strategy(features.column("strategy")[0].as_py())
        if strategy is None or strategy not in self.certainties:
            return ModelAnswer(probabilities)
        # The scores of the training objects are from only the first touches of each view.
        first = first_touches(features, self.touches)
        rows = np.concatenate(
            [descriptors_of(self.estimator[:-1].transform(part)) for part in self._rows(first)]
        )
        coverage = self.parameters.order_free.coverage
        certainty = self.certainties[strategy]
        assessment = certainty.assess(rows, logs, coverage)
        # A conformal set can be empty or lack the named class. A larger set covers at least as often.
        in_set = assessment.candidates | (np.arange(len(order)) == order[0])
        return ModelAnswer(
            probabilities,
            tuple(self.classes[index] for index in order if in_set[index]),
            assessment.novelty_rank,
            assessment.unknown if self.can_call_unknown(strategy) else None,
            coverage,
            len(certainty.labels),
        )

    def matching_strategy(self, strategy: str) -> str | None:
        """Return the first of `strategies` that is `strategy`, or another draw of it; None if there is none.

        ``random``, ``random#1`` and ``random#2`` are draws of strategy ``random``.
        """
        kind, _ = draw_of(strategy)
        return next((name for name in self.strategies if draw_of(name)[0] == kind), None)

    def can_call_unknown(self, strategy: str) -> bool:
        """Return whether the model learnt enough objects by `strategy` to call an object unknown."""
        certainty = self.certainties.get(self.matching_strategy(strategy) or "")
        least = least_known_objects(self.parameters.order_free.coverage)
        return certainty is not None and len(certainty.labels) >= least

    def check(self) -> None:
        """Raise `ValueError` if parts of the model don't fit each other, or can't classify a sequence of zeros."""
        zeros = np.zeros((1, self.touches, len(self.feature_names)))
        logs = self._pooled_logs(self._describe([zeros]))
        if not self.strategies or not set(self.certainties) <= set(self.strategies):
            raise ValueError("the strategies and the certainties do not fit each other")
        knows_classes = np.array_equal(self.estimator[-1].classes_, np.arange(len(self.classes)))
        if not knows_classes or logs.shape != (len(self.classes),) or not np.isfinite(logs).all():
            raise ValueError(f"no probabilities of {len(self.classes)} classes")

    def _pooled_logs(self, rows: Sequence[Any]) -> FloatArray:
        """Compute the log probability of each class, (c,): mean over sequences, or share of votes in ``paper``."""
        prepared = [self.estimator[:-1].transform(part) for part in rows]
        if self.pipeline == "paper":
            votes = np.concatenate([self.estimator[-1].predict(part) for part in prepared])
            shares = np.bincount(votes, minlength=len(self.classes)) / len(votes)
            with np.errstate(divide="ignore"):
                return np.log(shares)
        logs = np.concatenate(
            [log_probabilities(self.estimator[-1], part, len(self.classes)) for part in prepared]
        )
        all_sequences = np.ones((1, len(logs)), dtype=bool)
        return pooled_log_probabilities(logs, all_sequences)[0]

    def _rows(self, features: pa.Table) -> list[Any]:
        """Return the input of the estimator from the touches of one object, one row per sequence, in one array or several."""
        if not features.num_rows:
            raise RecognitionError("There is no touch; an object is classified from one touch on.")
        groups = gather_any(spread_contact_states(features), self.feature_names, self.touches)
        if self._needs_all_bands:
            check_directions(len(filled_bands(features)))
        if self.pipeline == "paper":  # wavelet levels need whole sequences
            groups = [group for group in groups if group.shape[1] == self.touches]
        if self.pipeline == "learned" and learns_pairs(self.parameters.frame, self.touches):
            groups = [group for group in groups if group.shape[1] > 1]
        if self.parameters.order == "shuffled":
            order = spawn_generator(0, "order")
            groups = [
                np.stack([order.permutation(sequence) for sequence in group]) for group in groups
            ]
        if not groups:
            needed = self.touches if self.pipeline == "paper" else 2
            raise RecognitionError(
                f"No viewpoint has {needed} touches, which the model needs: the object is too "
                "slender in all views; touch it from other viewpoints."
            )
        return self._describe(groups)

    @property
    def _needs_all_bands(self) -> bool:
        """Whether all directional bands are needed: roll-free descriptors are Fourier amplitudes over directions."""
        parameters = self.parameters
        is_rolling = self.pipeline != "paper" and parameters.frame in ROLLING_FRAMES
        has_bands = CONTOURLET_FEATURES[0] in self.feature_names
        return is_rolling and has_bands and "contourlet" in parameters.order_free.cues

    def _describe(self, groups: Sequence[FloatArray]) -> list[Any]:
        """Return one row per sequence from groups (s, t, k) of s sequences; each group has another length t."""
        if self.waves is None:
            return [np.concatenate(groups)]
        compute = learned_rows if self.pipeline == "learned" else describe_sequences
        described = [
            compute(group, self.feature_names, self.waves, self.parameters) for group in groups
        ]
        # A longer sequence has more elements, so rows of `learned` stay apart by group.
        return described if self.pipeline == "learned" else [np.concatenate(described)]


def fit_model(
    features: pa.Table,
    pipeline: str,
    classifier: ClassifierName,
    parameters: RecognitionParameters,
    seed: int,
    folds: int = FOLDS,
) -> RecognitionModel:
    """Fit a model on all objects of a table.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES` of one strategy or several. Viewpoints with fewer than `parameters.touches` touches
        are left out, with a warning in the log. If `parameters.touches` is None, the number is that of the longest
        sequence of the strategy.
    pipeline : {"paper", "order_free", "learned"}
        Pipeline to fit.
    classifier : str
        Name of `CLASSIFIERS`; ``touch_network`` in pipeline ``learned``.
    parameters : RecognitionParameters
        Settings of the fit.
    seed : int
        Seed of the fit, and of the random waves of pipeline ``order_free``.
    folds : int
        Maximum number of folds of the training objects, from which the scores of `certainties` are computed. The model
        has the same size for any number.

    Raises
    ------
    RecognitionError
        If the table has fewer than two classes, no sequence with enough touches, a missing column, a value that is not
        finite, or strategies with different numbers of touches per sequence. Also if there is no such pipeline.
    RegistryError
        If there is no such classifier.
    """
    strategies = tuple(features.column("strategy").unique().to_pylist())
    rows_of = [features.filter(pc.equal(features.column("strategy"), name)) for name in strategies]
    of_strategies = [gather_pipeline(part, parameters, pipeline, seed) for part in rows_of]
    sequences = join_sequences(of_strategies)
    strategy_of_row = np.repeat(strategies, [len(part.features) for part in of_strategies])
    check_two_classes(sequences)
    parts = pipeline_of(pipeline, _with_only_classifier(parameters, classifier), seed)
    if classifier not in parts.classifiers:
        raise RecognitionError(
            f"Pipeline {pipeline} has no classifier {classifier}; {', '.join(parts.classifiers)} is allowed."
        )
    rows, labels, owners = parts.rows(sequences), sequences.labels, sequences.object_index
    generator = spawn_generator(seed, "recognition", "model", pipeline)
    fit = partial(_fit_estimator, parts, classifier, generator)
    has_probabilities = pipeline != "paper"
    certainties: dict[str, Certainty] = {}
    with one_thread():
        estimator = fit(rows, labels, owners)
        for name in strategies if has_probabilities else ():
            certainty = fit_certainty(
                fit,
                estimator,
                rows,
                labels,
                owners,
                same_strategy=strategy_of_row == name,
                folds=folds,
            )
            certainties |= {} if certainty is None else {name: certainty}
    waves = draw_waves(parameters.order_free, seed) if has_probabilities else None
    return RecognitionModel(
        pipeline=pipeline,
        strategies=strategies,
        classifier=classifier,
        classes=sequences.classes,
        feature_names=sequences.feature_names,
        touches=sequences.features.shape[1],
        objects=sequences.objects,
        parameters=parameters,
        versions=_versions(),
        estimator=estimator,
        waves=waves,
        certainties=certainties,
    )


def _fit_estimator(
    parts: RecognitionPipeline,
    classifier: str,
    generator: np.random.Generator,
    rows: FloatArray,
    labels: IntArray,
    owners: IntArray,
) -> Pipeline:
    """Fit the preparation and a classifier on training sequences; a classifier with probabilities is calibrated."""
    preparation = seeded(clone(parts.preparation), generator)
    prepared = fit_preparation(preparation, rows)
    (own_seed,) = parts.seeds(generator).values()
    model = seeded(clone(parts.classifiers[classifier]), own_seed)
    fitted = (
        model.fit(prepared, labels)
        if parts.name == "paper"
        else fit_calibrated(model, prepared, labels, owners)
    )
    return Pipeline([("preparation", preparation), ("classifier", fitted)])


def _versions() -> dict[str, str]:
    """Return the versions of the packages on which a fitted model depends, by name."""
    packages = {name: version(name) for name in ("numpy", "scikit-learn", "pywavelets", "skops")}
    return {"visuohaptic": __version__, "python": platform.python_version(), **packages}


def _with_only_classifier(
    parameters: RecognitionParameters, classifier: str
) -> RecognitionParameters:
    """Return parameters in which `classifier` is the only classifier of both pipelines."""
    order_free = parameters.order_free.model_copy(update={"classifiers": (classifier,)})
    return parameters.model_copy(update={"order_free": order_free, "classifiers": (classifier,)})
