"""Descriptors of a sequence of touches, independent of their order: the input of pipeline `order_free`.

Nothing here is fitted. Objects stand upright, y up, with their front along z, and
most are about left-right symmetric; the mirrored and view-invariant descriptors
build on that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.encoding import ROUNDING
from visuohaptic.recognition.parameters import OrderFreeParameters, RecognitionParameters
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline
from visuohaptic.tables.phases import KINESTHETIC_FEATURES

POSE = KINESTHETIC_FEATURES
LEAST_SIZE = 1e-6


@dataclass(frozen=True)
class WaveBasis:
    """Plane waves over the six numbers of a pose: directions (6, w) and phases (w,), radians.

    Their means over a sequence are the kernel mean embedding of its poses in a Gaussian kernel (A.
    Rahimi and B. Recht, "Random features for large-scale kernel machines", NIPS 2007).
    """

    directions: FloatArray
    phases: FloatArray


def draw_waves(parameters: OrderFreeParameters, seed: int) -> WaveBasis:
    """Draw waves for a Gaussian kernel of `wave_length` over positions, by the experiment's seed."""
    generator = spawn_generator(seed, "recognition", "waves")
    weights = np.array([1, 1, 1, *[parameters.normal_weight] * 3]) / parameters.wave_length
    directions = generator.normal(size=(6, parameters.waves)) * weights[:, None]
    return WaveBasis(directions, generator.uniform(0, 2 * np.pi, size=parameters.waves))


def describe_all(
    sequences: TouchSequences, parameters: OrderFreeParameters, seed: int
) -> FloatArray:
    """Describe s sequences with the waves that the experiment's seed draws: (s, d)."""
    waves = draw_waves(parameters, seed)
    return describe_sequences(sequences.features, sequences.feature_names, waves, parameters)


def touch_descriptors(
    features: pa.Table, parameters: RecognitionParameters | None = None, seed: int = 2018
) -> tuple[FloatArray, NDArray[np.str_], NDArray[np.str_]]:
    """Compute the inputs of a scikit-learn classifier from touches of one strategy.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES`.
    parameters : RecognitionParameters, optional
        Cues and waves (`order_free`), and the number of touches per sequence.
    seed : int
        Draws the waves; use one seed for training and test.

    Returns
    -------
    descriptors : ndarray of shape (s, d)
        One row per sequence. Viewpoints with too few touches are left out.
    classes : ndarray of shape (s,)
    objects : ndarray of shape (s,)
        ``class/name``: the `groups` of scikit-learn's splitters.

    Raises
    ------
    RecognitionError
        If there is no whole sequence, or a column is missing.

    Examples
    --------
    >>> rows, classes, objects = touch_descriptors(features)  # doctest: +SKIP
    >>> folds = StratifiedGroupKFold(5)  # doctest: +SKIP
    >>> cross_val_score(make_order_free(), rows, classes, groups=objects, cv=folds)  # doctest: +SKIP
    """
    own = parameters or RecognitionParameters()
    sequences = gather_pipeline(features, own, "order_free")
    owners = [sequences.objects[index] for index in sequences.object_index]
    return (
        describe_all(sequences, own.order_free, seed),
        np.array([category for category, _ in owners]),
        np.array([f"{category}/{name}" for category, name in owners]),
    )


def describe_sequences(
    features: FloatArray, names: Sequence[str], waves: WaveBasis, parameters: OrderFreeParameters
) -> FloatArray:
    """Describe sequences (s, t, k) by statistics and relations of their touches: (s, d).

    The k columns `names` are the pose, and what there is of others. Raises `RecognitionError` if a
    column of the pose is missing or no cue has a column.
    """
    missing = [name for name in POSE if name not in names]
    if missing:
        raise RecognitionError(f"The features lack the columns {', '.join(missing)} of the pose.")
    pose = features[:, :, [list(names).index(name) for name in POSE]]
    points, normals = pose[:, :, :3], pose[:, :, 3:]
    makers = {
        "contourlet": lambda: statistics(_columns(features, names, "contourlet_")),
        "imprint": lambda: statistics(_columns(features, names, "imprint_")),
        "sensor": lambda: _describe_sensor(features, names),
        "pose": lambda: statistics(pose_coordinates(points, normals)),
        "relations": lambda: describe_relations(points, normals),
        "embedding": lambda: embed_poses(points, normals, waves),
        "azimuth_free": lambda: _describe_azimuth_free(points, normals, waves),
    }
    described = np.concatenate([makers[cue]() for cue in parameters.cues], axis=1)
    if not described.shape[1]:
        raise RecognitionError(
            f"The features have no column for the cues {', '.join(parameters.cues)}; "
            f"pose, relations and embedding need none but the pose."
        )
    return described


def statistics(values: FloatArray) -> FloatArray:
    """Give mean, standard deviation, minimum and maximum over touches: (s, t, k) to (s, 4 k)."""
    parts = (values.mean(axis=1), values.std(axis=1), values.min(axis=1), values.max(axis=1))
    return np.concatenate(parts, axis=1)


def pose_coordinates(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Give poses in the object's frame, mirrored, and free of azimuth, of (s, t, 3) each: (s, t, 16).

    The last five are distance from the upright axis and from the centre, and how far the normal
    points away from the centre, away from the axis, and around it.
    """
    axial = np.hypot(points[..., 0], points[..., 2])
    radius = np.linalg.norm(points, axis=-1)
    outward = (points * normals).sum(axis=-1) / np.maximum(radius, LEAST_SIZE)
    level = points[..., 0] * normals[..., 0] + points[..., 2] * normals[..., 2]
    around = points[..., 0] * normals[..., 2] - points[..., 2] * normals[..., 0]
    free = [axial, radius, outward]
    free += [turn / np.maximum(axial, LEAST_SIZE) for turn in (level, np.abs(around))]
    return np.concatenate(
        [points, normals, np.abs(points[..., ::2]), np.abs(normals), np.stack(free, axis=-1)],
        axis=-1,
    )


def azimuth_free_coordinates(
    points: FloatArray, normals: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Turn touches (s, t, 3) about the upright axis into the plane of x and y, on one side."""
    axial = np.hypot(points[..., 0], points[..., 2])
    way = points[..., ::2] / np.maximum(axial, LEAST_SIZE)[..., None]
    away = (way * normals[..., ::2]).sum(axis=-1)
    around = np.abs(way[..., 0] * normals[..., 2] - way[..., 1] * normals[..., 0])
    placed = np.stack([axial, points[..., 1], np.zeros_like(axial)], axis=-1)
    return placed, np.stack([away, normals[..., 1], around], axis=-1)


def _describe_azimuth_free(points: FloatArray, normals: FloatArray, waves: WaveBasis) -> FloatArray:
    placed, turned = azimuth_free_coordinates(points, normals)
    coordinates = np.concatenate([placed[..., :2], turned], axis=-1)
    embedded = embed_poses(placed, turned, waves)
    return np.concatenate([statistics(coordinates), embedded], axis=1)


def describe_relations(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Describe how the touches of a sequence lie to one another, of (s, t, 3) each: (s, 27).

    Statistics over all pairs of touches, then the three principal extents of the points. A single
    touch has no pair, and zeros.
    """
    touches = points.shape[1]
    centred = points - points.mean(axis=1, keepdims=True)
    scatter = np.einsum("sti,stj->sij", centred, centred) / touches
    squares = np.linalg.eigvalsh(scatter)
    # Of points in a plane the least is rounding, whose root is far larger.
    squares[squares <= ROUNDING * squares[:, -1:]] = 0.0
    extents = np.sqrt(squares)
    if touches == 1:
        return np.zeros((len(points), 27))
    first, second = np.triu_indices(touches, 1)
    step = points[:, second] - points[:, first]
    distance = np.linalg.norm(step, axis=-1)
    along = step / np.maximum(distance, LEAST_SIZE)[..., None]
    leaving = (normals[:, first] * along).sum(axis=-1)
    arriving = (normals[:, second] * along).sum(axis=-1)
    pairs = [
        distance,
        np.abs(step[..., 1]),
        np.hypot(step[..., 0], step[..., 2]),
        (normals[:, first] * normals[:, second]).sum(axis=-1),
        arriving - leaving,
        np.abs(arriving + leaving),
    ]
    return np.concatenate([statistics(np.stack(pairs, axis=-1)), extents], axis=1)


def embed_poses(points: FloatArray, normals: FloatArray, waves: WaveBasis) -> FloatArray:
    """Give the mean of each wave over a sequence's poses, left and right alike: (s, t, 3) to (s, w)."""
    pose = np.concatenate([points, normals], axis=-1)
    pose[..., [0, 3]] = np.abs(pose[..., [0, 3]])
    return np.sqrt(2) * np.cos(pose @ waves.directions + waves.phases).mean(axis=1)


def _columns(features: FloatArray, names: Sequence[str], prefix: str) -> FloatArray:
    places = [place for place, name in enumerate(names) if name.startswith(prefix)]
    return features[:, :, places]


def _describe_sensor(features: FloatArray, names: Sequence[str]) -> FloatArray:
    size = np.log(np.maximum(_columns(features, names, "sensor_size"), LEAST_SIZE))
    states = _columns(features, names, "contact_").mean(axis=1)
    return np.concatenate([statistics(size), states], axis=1)
