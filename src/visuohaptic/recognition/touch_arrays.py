"""Sequences of touches as arrays: imprints and poses, for estimators that do not use our features."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.base.errors import RecognitionError, TableError
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import (
    TouchSequences,
    gather_sequences,
    shuffle_touches,
    whole_sequences,
)
from visuohaptic.tables.phases import KINESTHETIC_FEATURES
from visuohaptic.tables.schema import images_or_readings

_ROW = "row"


def touch_arrays(
    touches: pa.Table, parameters: RecognitionParameters | None = None, seed: int = 2018
) -> tuple[NDArray[np.void], NDArray[np.str_], NDArray[np.str_]]:
    """Return the imprints and poses of sequences of touches, for classifiers of your own.

    Parameters
    ----------
    touches : pyarrow.Table
        Rows of `tables.TOUCHES` of one strategy, such as those of ``results/touches``.
    parameters : RecognitionParameters, optional
        The number of touches per sequence, and their order.
    seed : int
        Draws the order, where `parameters` ask for another one.

    Returns
    -------
    sequences : structured ndarray of shape (n, t)
        One row per sequence. Field ``imprint`` has shape (n, t, r, r), float32, from 0, its farthest point,
        to 1, its nearest; with `sensor.normalisation` ``absolute``, from 0, out of the depth range, to 1, contact.
        Imprints of a layout without rows and columns have shape (n, t, taxels).
        Field ``pose`` has shape (n, t, 6), float32: position in object radii and outward unit normal,
        object frame. Field ``sensor_size`` has shape (n, t), float32, object radii.
    classes : ndarray of shape (n,)
    objects : ndarray of shape (n,)
        ``class/name``: the `groups` of scikit-learn's splitters.

    Raises
    ------
    RecognitionError
        If the table has no imprints, or no whole sequence.

    Examples
    --------
    >>> sequences, classes, objects = touch_arrays(touches)  # doctest: +SKIP
    >>> sequences["imprint"].shape, sequences["pose"].shape  # doctest: +SKIP
    ((192, 5, 32, 32), (192, 5, 6))
    """
    gathered, arrays = gather_touches(touches, parameters or RecognitionParameters(), seed)
    owners = [gathered.objects[index] for index in gathered.object_index]
    return (
        arrays,
        np.array([category for category, _ in owners]),
        np.array([f"{category}/{name}" for category, name in owners]),
    )


def gather_touches(
    touches: pa.Table, parameters: RecognitionParameters, seed: int
) -> tuple[TouchSequences, NDArray[np.void]]:
    """Gather the touches of one strategy: sequences with their poses, and `touch_arrays`' first array."""
    imprints = _imprints(touches)
    names = [*KINESTHETIC_FEATURES, "sensor_size"]
    # pyarrow can't join tables with lists, so a row number replaces each imprint.
    numbered = touches.drop_columns(["image"]).append_column(_ROW, [np.arange(len(touches))])
    whole, _ = whole_sequences(numbered, parameters.touches)
    sequences = gather_sequences(whole, [*names, _ROW], parameters.touches)
    if parameters.order == "shuffled":
        sequences = shuffle_touches(sequences, seed)
    values, rows = sequences.features[..., :-1], sequences.features[..., -1].astype(np.int64)
    kind = [("imprint", "f4", imprints.shape[1:]), ("pose", "f4", 6), ("sensor_size", "f4")]
    arrays = np.empty(rows.shape, dtype=kind)
    arrays["imprint"] = imprints[rows]
    arrays["pose"], arrays["sensor_size"] = values[..., :6], values[..., 6]
    return replace(sequences, features=values, feature_names=tuple(names)), arrays


def flatten_touches(sequences: NDArray[np.void]) -> NDArray[np.float32]:
    """Return one row of numbers per sequence, for estimators that take two-dimensional arrays.

    Parameters
    ----------
    sequences : structured ndarray of shape (n, t)
        As `touch_arrays` returns them.

    Returns
    -------
    ndarray of shape (n, t * (r * r + 7)), float32
        Touch by touch: the imprint row by row, the pose, the sensor's size.

    Examples
    --------
    >>> from sklearn.pipeline import make_pipeline
    >>> from sklearn.preprocessing import FunctionTransformer, StandardScaler
    >>> from sklearn.svm import SVC
    >>> estimator = make_pipeline(FunctionTransformer(flatten_touches), StandardScaler(), SVC())
    """
    count, touches = sequences.shape
    parts = [
        np.reshape(sequences[name], (count, touches, -1))
        for name in ("imprint", "pose", "sensor_size")
    ]
    return np.concatenate(parts, axis=2).reshape(count, -1)


def _imprints(touches: pa.Table) -> NDArray[np.float32]:
    if "image" not in touches.column_names:
        raise RecognitionError(
            "The table has no imprints (column image); a table of touches is needed, such as results/touches."
        )
    try:
        return images_or_readings(touches)
    except TableError as error:
        raise RecognitionError(f"The touches can't be used: {error}") from error
