"""Compute the input of the evaluated classifier from sequences of touches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from sklearn.preprocessing import FunctionTransformer

from visuohaptic.base.errors import ParameterError
from visuohaptic.recognition.classifiers import Classifier
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.pipelines import (
    ORDER_FREE_SETTINGS,
    OrderFreePipeline,
    PaperPipeline,
    RecognitionPipeline,
    make_order_free,
)
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline
from visuohaptic.recognition.touch_arrays import gather_touches
from visuohaptic.tables.phases import FEATURES, TOUCHES
from visuohaptic.tables.schema import Schema

Inputs = Literal["features", "descriptors", "touches"]

SCHEMAS: Mapping[Inputs, Schema] = {
    "features": FEATURES,
    "descriptors": FEATURES,
    "touches": TOUCHES,
}
"""The table from which each kind of input is computed."""


@dataclass(frozen=True)
class Prepared:
    """Sequences of one strategy, one input row per sequence, and the unfitted pipeline that takes these rows."""

    sequences: TouchSequences
    rows: NDArray[Any]
    pipeline: RecognitionPipeline


@dataclass(frozen=True)
class TouchPipeline:
    """Pipeline that passes imprints and poses unchanged to the classifier."""

    preparation: FunctionTransformer
    classifiers: Mapping[str, Any]
    name: str = "touches"

    def rows(self, sequences: TouchSequences) -> NDArray[Any]:
        """Return the poses (n, d); `gather_touches` adds the imprints."""
        return sequences.features

    def seeds(self, generator: np.random.Generator) -> dict[str, int]:
        """Draw one seed per classifier."""
        return {name: int(generator.integers(2**31)) for name in self.classifiers}

    def log_probabilities(self, fitted: Any, rows: Any, classes: int) -> None:
        """Return None: evaluation counts predicted classes."""


def check_inputs(inputs: str) -> Inputs:
    """Check the name of an input. Raises `ParameterError` if the name is unknown."""
    is_text = isinstance(inputs, str)
    for name in get_args(Inputs):
        if is_text and inputs == name:
            return name
    given = repr(inputs) if is_text else f"of type {type(inputs).__name__}"
    raise ParameterError(f"inputs is {given}; {', '.join(get_args(Inputs))} are allowed.")


def prepare(
    inputs: Inputs,
    table: pa.Table,
    classifier: Classifier,
    parameters: RecognitionParameters,
    seed: int,
) -> Prepared:
    """Gather the sequences of one strategy and compute the classifier's input.

    Parameters
    ----------
    inputs : {"features", "descriptors", "touches"}
        The kind of input.
    table : pyarrow.Table
        Rows of `SCHEMAS[inputs]` with whole sequences of one strategy.
    classifier : Classifier
        The classifier behind the input.
    parameters : RecognitionParameters
        The sequences and their encoding.
    seed : int
        The experiment's seed.

    Returns
    -------
    Prepared
        The sequences, (n, ...) input rows, and the unfitted pipeline.

    Raises
    ------
    RecognitionError
        If the table has no whole sequence.
    """
    if inputs == "touches":
        sequences, arrays = gather_touches(table, parameters, seed)
        own = {classifier.name: classifier.make(parameters.classifier)}
        return Prepared(sequences, arrays, TouchPipeline(FunctionTransformer(), own))
    pipeline: RecognitionPipeline
    if inputs == "features":
        pipeline = PaperPipeline.of(parameters, {classifier.name: classifier})
    else:
        own = {classifier.name: classifier.make(ORDER_FREE_SETTINGS)}
        pipeline = OrderFreePipeline(parameters, seed, make_order_free()[:-1], own)
    sequences = gather_pipeline(table, parameters, pipeline.name, seed)
    return Prepared(sequences, pipeline.rows(sequences), pipeline)
