"""Descriptors of poses that use only the known part of the object's frame.

Points and normals have the shape (s, t, 3): s sequences of t touches, in object radii and as unit
vectors. The names of functions say what they take as known: the rigid ones nothing, the central ones
the object's centre, which is the origin, and the upright ones also the vertical, which is y.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.recognition.encoding import ROUNDING

LEAST_SIZE = 1e-6
"""Shorter vectors have no direction: they are divided by this length instead of their own (object radii)."""

WAVES_AT_ONCE = 2**23
"""Values of waves that are in memory at the same time."""


@dataclass(frozen=True)
class WaveBasis:
    """Plane waves over three lengths and three cosines: directions (6, w) and phases (w,), radians.

    Their means over a sequence are the kernel mean embedding of its touches, or of its pairs of
    touches, in a Gaussian kernel (A. Rahimi and B. Recht, "Random features for large-scale kernel
    machines", NIPS 2007).
    """

    directions: FloatArray
    phases: FloatArray


@dataclass(frozen=True)
class TouchPairs:
    """Pairs of touches of s sequences, from a first touch to a second touch, by p pairs.

    Attributes
    ----------
    first, second : ndarray of shape (p,)
        Index of each touch in its sequence.
    step : ndarray of shape (s, p, 3)
        From the first point to the second.
    distance, leaving, arriving, agreement : ndarray of shape (s, p)
        Length of the step; cosines of the first and of the second normal to the step, and between
        the normals. These are the point pair features (B. Drost et al., "Model globally, match
        locally", CVPR 2010). The cosines to a step of length 0 are 0.
    along : ndarray of shape (s, p, 3)
        Unit vector of the step.
    """

    first: IntArray
    second: IntArray
    step: FloatArray
    distance: FloatArray
    along: FloatArray
    leaving: FloatArray
    arriving: FloatArray
    agreement: FloatArray


def pair_touches(
    points: FloatArray, normals: FloatArray, first: IntArray, second: IntArray
) -> TouchPairs:
    """Compute the point pair features of the touches with the indices `first` and `second`, (p,) each."""
    step = points[:, second] - points[:, first]
    distance = np.linalg.norm(step, axis=-1)
    along = step / np.maximum(distance, LEAST_SIZE)[..., None]
    return TouchPairs(
        first,
        second,
        step,
        distance,
        along,
        leaving=(normals[:, first] * along).sum(axis=-1),
        arriving=(normals[:, second] * along).sum(axis=-1),
        agreement=(normals[:, first] * normals[:, second]).sum(axis=-1),
    )


def each_pair(points: FloatArray, normals: FloatArray) -> TouchPairs:
    """Pair each touch with each later one: t (t - 1) / 2 pairs."""
    return pair_touches(points, normals, *np.triu_indices(points.shape[1], 1))


def both_ways(points: FloatArray, normals: FloatArray) -> TouchPairs:
    """Pair each touch with each other one, so that no order of touches matters to means: t (t - 1) pairs."""
    is_other = ~np.eye(points.shape[1], dtype=bool)
    return pair_touches(points, normals, *np.nonzero(is_other))


def statistics(values: FloatArray) -> FloatArray:
    """Compute mean, standard deviation, minimum and maximum over touches or pairs: (s, n, k) to (s, 4 k).

    Without any touch or pair the statistics are 0.
    """
    if not values.shape[1]:
        return np.zeros((len(values), 4 * values.shape[2]))
    parts = (values.mean(axis=1), values.std(axis=1), values.min(axis=1), values.max(axis=1))
    return np.concatenate(parts, axis=1)


def principal_extents(points: FloatArray) -> FloatArray:
    """Compute the standard deviations of points along their principal axes, the least first: (s, 3)."""
    centred = points - points.mean(axis=1, keepdims=True)
    scatter = np.einsum("sti,stj->sij", centred, centred) / points.shape[1]
    squares = np.linalg.eigvalsh(scatter)
    # The smallest eigenvalue of points in a plane is rounding. Its root would look like a true extent.
    squares[squares <= ROUNDING * squares[:, -1:]] = 0.0
    return np.sqrt(squares)


def central_coordinates(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Compute the distance from the centre and the cosine of the normal to the way from there: (s, t, 2)."""
    radius = np.linalg.norm(points, axis=-1)
    outward = (points * normals).sum(axis=-1) / np.maximum(radius, LEAST_SIZE)
    return np.stack([radius, outward], axis=-1)


def rigid_coordinates(points: FloatArray, normals: FloatArray) -> FloatArray:  # noqa: ARG001 - as all frames
    """Return no coordinates, shape (s, t, 0): without a frame a single touch has no pose."""
    return points[..., :0]


def upright_coordinates(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Compute what a turn about the vertical leaves of touches: (s, t, 7).

    Distance from the axis and height, cosines of the normal to the way from the axis, to the
    vertical and, as a size, to the way around, then `central_coordinates`.
    """
    ways = radial_ways(points)
    around = ways[..., 0] * normals[..., 2] - ways[..., 1] * normals[..., 0]
    known = [
        np.hypot(points[..., 0], points[..., 2]),
        points[..., 1],
        (ways * normals[..., ::2]).sum(axis=-1),
        normals[..., 1],
        np.abs(around),
    ]
    central = central_coordinates(points, normals)
    return np.concatenate([np.stack(known, axis=-1), central], axis=-1)


def radial_ways(points: FloatArray) -> FloatArray:
    """Compute the horizontal unit vectors, x and z, from the vertical axis to the points: (s, t, 2)."""
    level = points[..., ::2]
    axial = np.linalg.norm(level, axis=-1, keepdims=True)
    return level / np.maximum(axial, LEAST_SIZE)


def rigid_relations(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Describe pairs of touches and the extents of all: (s, 23).

    Statistics of the distance, of the cosine between normals, of the sum and the difference of both
    cosines to the connecting line, and of the size of the triple product of normals and line.
    """
    pairs = each_pair(points, normals)
    across = np.cross(normals[:, pairs.first], normals[:, pairs.second])
    values = [
        pairs.distance,
        pairs.agreement,
        pairs.arriving - pairs.leaving,
        np.abs(pairs.arriving + pairs.leaving),
        np.abs((across * pairs.along).sum(axis=-1)),
    ]
    described = statistics(np.stack(values, axis=-1))
    return np.concatenate([described, principal_extents(points)], axis=1)


def central_relations(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Compute `rigid_relations` and statistics of the cosine between the ways from the centre: (s, 27)."""
    radius = np.linalg.norm(points, axis=-1, keepdims=True)
    ways = points / np.maximum(radius, LEAST_SIZE)
    first, second = np.triu_indices(points.shape[1], 1)
    opening = (ways[:, first] * ways[:, second]).sum(axis=-1, keepdims=True)
    return np.concatenate([rigid_relations(points, normals), statistics(opening)], axis=1)


def turning_relations(points: FloatArray) -> FloatArray:
    """Describe the turns about the vertical from touch to touch: (s, 12).

    Statistics of the cosine, of the size of the sine, and of the sine times the rise, which has one
    sign for both orders of the touches.
    """
    ways = radial_ways(points)
    first, second = np.triu_indices(points.shape[1], 1)
    ahead, behind = ways[:, second], ways[:, first]
    sine = behind[..., 0] * ahead[..., 1] - behind[..., 1] * ahead[..., 0]
    rise = points[:, second, 1] - points[:, first, 1]
    turns = [(behind * ahead).sum(axis=-1), np.abs(sine), sine * rise]
    return statistics(np.stack(turns, axis=-1))


def embed(coordinates: FloatArray, waves: WaveBasis) -> FloatArray:
    """Compute the mean of each wave over touches or pairs: (s, n, 6) to (s, w); 0 where n is 0."""
    sequences, count, _ = coordinates.shape
    if not count:
        return np.zeros((sequences, len(waves.phases)))
    step = max(1, WAVES_AT_ONCE // (count * len(waves.phases)))
    means = [
        np.cos(coordinates[start : start + step] @ waves.directions + waves.phases).mean(axis=1)
        for start in range(0, sequences, step)
    ]
    return np.sqrt(2) * np.concatenate(means)


def embed_rigid(points: FloatArray, normals: FloatArray, waves: WaveBasis) -> FloatArray:
    """Embed the point pair features of all pairs: (s, w)."""
    pairs = both_ways(points, normals)
    nothing = np.zeros_like(pairs.distance)
    return embed(pair_coordinates(pairs, pairs.distance, nothing, nothing), waves)


def embed_central(points: FloatArray, normals: FloatArray, waves: WaveBasis) -> FloatArray:
    """Embed `central_coordinates`, and pairs by distance, distances from the centre and cosines: (s, 2 w)."""
    central = central_coordinates(points, normals)
    radius, outward = central[..., 0], central[..., 1]
    nothing = np.zeros_like(radius)
    touches = np.stack([radius, nothing, nothing, outward, nothing, nothing], axis=-1)
    pairs = both_ways(points, normals)
    ends = radius[:, pairs.first], radius[:, pairs.second]
    paired = pair_coordinates(pairs, pairs.distance, *ends)
    return np.concatenate([embed(touches, waves), embed(paired, waves)], axis=1)


def embed_upright(points: FloatArray, normals: FloatArray, waves: WaveBasis) -> FloatArray:
    """Embed `upright_coordinates`, and pairs by level distance, heights and cosines: (s, 2 w)."""
    upright = upright_coordinates(points, normals)
    touches = np.insert(upright[..., :5], 2, 0.0, axis=-1)
    pairs = both_ways(points, normals)
    level = np.hypot(pairs.step[..., 0], pairs.step[..., 2])
    paired = pair_coordinates(pairs, level, points[:, pairs.first, 1], points[:, pairs.second, 1])
    return np.concatenate([embed(touches, waves), embed(paired, waves)], axis=1)


def pair_coordinates(pairs: TouchPairs, *lengths: FloatArray) -> FloatArray:
    """Stack three lengths, (s, p) each, and the three cosines of pairs: (s, p, 6)."""
    return np.stack([*lengths, pairs.leaving, pairs.arriving, pairs.agreement], axis=-1)
