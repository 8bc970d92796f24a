"""Descriptors of a sequence of touches, independent of the order of the touches: the input of pipeline `order_free`.

Nothing here is fitted. In frame `full` objects stand upright, y up, with their front along z, and
most are about left-right symmetric; the mirrored and view-invariant descriptors
build on that. The other frames know less (`frames`, `roll_free`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition.frames import (
    LEAST_SIZE,
    WaveBasis,
    central_coordinates,
    central_relations,
    each_pair,
    embed,
    embed_central,
    embed_rigid,
    embed_upright,
    principal_extents,
    rigid_coordinates,
    rigid_relations,
    statistics,
    turning_relations,
    upright_coordinates,
)
from visuohaptic.recognition.parameters import (
    ROLLING_FRAMES,
    Frame,
    OrderFreeParameters,
    RecognitionParameters,
)
from visuohaptic.recognition.roll_free import roll_free_bands, roll_free_imprint
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline
from visuohaptic.tables.phases import KINESTHETIC_FEATURES

POSE = KINESTHETIC_FEATURES


def draw_waves(parameters: OrderFreeParameters, seed: int) -> WaveBasis:
    """Draw waves for a Gaussian kernel of `wave_length` over positions, by the experiment's seed."""
    generator = spawn_generator(seed, "recognition", "waves")
    weights = np.array([1, 1, 1, *[parameters.normal_weight] * 3]) / parameters.wave_length
    directions = generator.normal(size=(6, parameters.waves)) * weights[:, None]
    return WaveBasis(directions, generator.uniform(0, 2 * np.pi, size=parameters.waves))


def describe_all(
    sequences: TouchSequences, parameters: RecognitionParameters, seed: int
) -> FloatArray:
    """Describe s sequences with the waves that the experiment's seed draws: (s, d)."""
    waves = draw_waves(parameters.order_free, seed)
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
        Cues and waves (`order_free`), the known frame, and the number of touches per sequence.
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
        describe_all(sequences, own, seed),
        np.array([category for category, _ in owners]),
        np.array([f"{category}/{name}" for category, name in owners]),
    )


def describe_sequences(
    features: FloatArray, names: Sequence[str], waves: WaveBasis, parameters: RecognitionParameters
) -> FloatArray:
    """Describe sequences (s, t, k) by statistics and relations of their touches: (s, d).

    The k columns `names` are the pose, and what there is of others. `parameters.frame` says what the
    descriptors may know of the object's pose. Raises `RecognitionError` if a column of the pose is
    missing, no cue has a column, or the columns do not allow the frame.
    """
    points, normals = pose_of(features, names)
    frame, cues = parameters.frame, parameters.order_free.cues
    nothing = np.zeros_like(points)
    makers = {
        "contourlet": lambda: statistics(_describe_bands(features, names, frame)),
        "imprint": lambda: statistics(_describe_imprint(features, names, frame)),
        "sensor": lambda: _describe_sensor(features, names),
        "pose": lambda: statistics(COORDINATES[frame](points, normals)),
        "relations": lambda: RELATIONS[frame](points, normals),
        "embedding": lambda: EMBEDDINGS[frame](points, normals, waves),
        "position": lambda: _describe_pose(points, nothing, waves, frame),
        "normal": lambda: _describe_pose(nothing, normals, waves, frame),
    }
    described = np.concatenate([makers[cue]() for cue in cues], axis=1)
    if not described.shape[1]:
        raise RecognitionError(
            f"There is no descriptor of the cues {', '.join(cues)} in frame {frame}: the features lack "
            f"their columns, or the frame knows nothing of them; relations and embedding need only the pose."
        )
    return described


def pose_of(features: FloatArray, names: Sequence[str]) -> tuple[FloatArray, FloatArray]:
    """Return the points and the normals of touches: (s, t, k) to 2 × (s, t, 3).

    Raises `RecognitionError` if a column of the pose is missing in `names`.
    """
    missing = [name for name in POSE if name not in names]
    if missing:
        raise RecognitionError(f"The features lack the columns {', '.join(missing)} of the pose.")
    pose = features[:, :, [list(names).index(name) for name in POSE]]
    return pose[:, :, :3], pose[:, :, 3:]


def describe_touches(features: FloatArray, names: Sequence[str], frame: Frame) -> FloatArray:
    """Compute bands, statistics of the imprint, logarithm of the sensor's size, and contact: (s, t, k) to (s, t, m).

    In a frame without roll, bands and statistics are those of `roll_free`. Columns that `names` lacks are left out.
    """
    return np.concatenate(
        [
            _describe_bands(features, names, frame),
            _describe_imprint(features, names, frame),
            _log_size(features, names),
            _columns(features, names, "contact_"),
        ],
        axis=-1,
    )


def pose_coordinates(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Compute coordinates of poses in the object's frame, mirrored, and without azimuth: 2 × (s, t, 3) to (s, t, 16).

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


def describe_relations(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Describe how the touches of a sequence lie to one another, of (s, t, 3) each: (s, 27).

    Statistics over all pairs of touches, then the three principal extents of the points. A single
    touch has no pair, and zeros.
    """
    pairs = each_pair(points, normals)
    values = [
        pairs.distance,
        np.abs(pairs.step[..., 1]),
        np.hypot(pairs.step[..., 0], pairs.step[..., 2]),
        pairs.agreement,
        pairs.arriving - pairs.leaving,
        np.abs(pairs.arriving + pairs.leaving),
    ]
    described = statistics(np.stack(values, axis=-1))
    return np.concatenate([described, principal_extents(points)], axis=1)


def upright_relations(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Compute `describe_relations` and the turns about the vertical from touch to touch: (s, 39)."""
    return np.concatenate([describe_relations(points, normals), turning_relations(points)], axis=1)


def embed_poses(points: FloatArray, normals: FloatArray, waves: WaveBasis) -> FloatArray:
    """Compute the mean of each wave over a sequence's poses, left and right alike: (s, t, 3) to (s, w)."""
    pose = np.concatenate([points, normals], axis=-1)
    pose[..., [0, 3]] = np.abs(pose[..., [0, 3]])
    return embed(pose, waves)


COORDINATES: Mapping[Frame, Callable[[FloatArray, FloatArray], FloatArray]] = {
    "none": rigid_coordinates,
    "centre": central_coordinates,
    "vertical": upright_coordinates,
    "full": pose_coordinates,
}
"""Coordinates of each touch that a frame knows, of points and normals."""

RELATIONS: Mapping[Frame, Callable[[FloatArray, FloatArray], FloatArray]] = {
    "none": rigid_relations,
    "centre": central_relations,
    "vertical": upright_relations,
    "full": describe_relations,
}
"""Relations of the touches to one another that a frame knows."""

EMBEDDINGS: Mapping[Frame, Callable[[FloatArray, FloatArray, WaveBasis], FloatArray]] = {
    "none": embed_rigid,
    "centre": embed_central,
    "vertical": embed_upright,
    "full": embed_poses,
}
"""Kernel mean embeddings of what a frame knows of touches and of pairs of touches."""


def _describe_pose(
    points: FloatArray, normals: FloatArray, waves: WaveBasis, frame: Frame
) -> FloatArray:
    """Compute the groups `pose`, `relations` and `embedding`; points or normals of 0 add only constants."""
    groups = (
        statistics(COORDINATES[frame](points, normals)),
        RELATIONS[frame](points, normals),
        EMBEDDINGS[frame](points, normals, waves),
    )
    return np.concatenate(groups, axis=1)


def _describe_bands(features: FloatArray, names: Sequence[str], frame: Frame) -> FloatArray:
    bands = _columns(features, names, "contourlet_")
    return roll_free_bands(bands) if frame in ROLLING_FRAMES else bands


def _describe_imprint(features: FloatArray, names: Sequence[str], frame: Frame) -> FloatArray:
    if frame in ROLLING_FRAMES:
        return roll_free_imprint(features, names)
    return _columns(features, names, "imprint_")


def _columns(features: FloatArray, names: Sequence[str], prefix: str) -> FloatArray:
    columns = [index for index, name in enumerate(names) if name.startswith(prefix)]
    return features[:, :, columns]


def _describe_sensor(features: FloatArray, names: Sequence[str]) -> FloatArray:
    states = _columns(features, names, "contact_").mean(axis=1)
    return np.concatenate([statistics(_log_size(features, names)), states], axis=1)


def _log_size(features: FloatArray, names: Sequence[str]) -> FloatArray:
    return np.log(np.maximum(_columns(features, names, "sensor_size"), LEAST_SIZE))
