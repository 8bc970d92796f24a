"""Descriptors of touches that are invariant to rotation and translation of all touches.

Points (object radii) and normals (unit vectors) have the shape (s, t, 3) for s sequences of t touches.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.recognition.frames import (
    LEAST_SIZE,
    WaveBasis,
    both_ways,
    central_coordinates,
    embed,
    embed_rigid,
    statistics,
)

Array = NDArray[np.float64]

KERNEL_WIDTHS = (0.175, 0.35, 0.7)
"""Widths of Gaussian kernels between points (object radii)."""

POWERS = (2, 3, 4)
"""Powers of kernel matrices whose traces describe their spectra."""


def pair_waves(points: Array, normals: Array, waves: WaveBasis) -> Array:
    """Embed the point pair features of all pairs of touches: (s, w)."""
    return embed_rigid(points, normals, waves)


def local_frames(points: Array, normals: Array, waves: WaveBasis) -> Array:
    """Describe each touch in the local reference frames of all other touches: (s, 24 + w).

    The first axis of a touch's frame is its normal. The second axis points, in the tangent plane, to the mean of the
    other touches. Frames with only the first axis are those of spin images (A. Johnson and M. Hebert, PAMI 1999). A
    second axis from the neighbours is that of SHOT (F. Tombari et al., ECCV 2010). Coordinates along the third axis are
    absolute values, so a mirrored object has the same descriptors.
    """
    touches = points.shape[1]
    others = (points.sum(axis=1, keepdims=True) - points) / max(touches - 1, 1)
    ways = others - points
    level = ways - (ways * normals).sum(axis=-1, keepdims=True) * normals
    second = level / np.maximum(np.linalg.norm(level, axis=-1, keepdims=True), LEAST_SIZE)
    third = np.cross(normals, second)
    pairs = both_ways(points, normals)
    seen = [pairs.step, normals[:, pairs.second]]
    local = [
        (vectors * axes[:, pairs.first]).sum(axis=-1)
        for vectors in seen
        for axes in (normals, second, third)
    ]
    coordinates = np.stack(local, axis=-1)
    coordinates[..., [2, 5]] = np.abs(coordinates[..., [2, 5]])
    return np.concatenate([statistics(coordinates), embed(coordinates, waves)], axis=1)


def spectral_moments(points: Array, normals: Array, waves: WaveBasis) -> Array:  # noqa: ARG001 - the signature of all families
    """Describe the touches of a sequence by moments and spectra of the whole set: (s, 34).

    - statistics of `central_coordinates` about the mean of the points
    - eigenvalues of the second moment of the normals, and the length of their mean
    - trace and singular values of the mixed moment of points and normals
    - traces of powers of kernel matrices between touches, without and with the cosine between normals
    """
    touches = points.shape[1]
    centred = points - points.mean(axis=1, keepdims=True)
    second = np.einsum("sti,stj->sij", normals, normals) / touches
    mixed = np.einsum("sti,stj->sij", centred, normals) / touches
    parts = [
        statistics(central_coordinates(centred, normals)),
        np.linalg.eigvalsh(second),
        np.linalg.norm(normals.mean(axis=1), axis=-1, keepdims=True),
        np.einsum("sii->s", mixed)[:, None],
        np.linalg.svd(mixed, compute_uv=False),
    ]
    squares = np.square(points[:, :, None] - points[:, None]).sum(axis=-1)
    cosines = np.einsum("sik,sjk->sij", normals, normals)
    for width in KERNEL_WIDTHS:
        kernel = np.exp(-squares / (2 * width**2))
        for matrices in (kernel, kernel * cosines):
            powers = [np.linalg.matrix_power(matrices / touches, power) for power in POWERS]
            parts += [np.einsum("sii->s", matrix)[:, None] for matrix in powers]
    return np.concatenate(parts, axis=1)


def triples(points: Array, normals: Array, waves: WaveBasis) -> Array:
    """Describe the triangles of all triples of touches: (s, 28 + w).

    - sides, sorted by length, and area
    - absolute mean, and mean absolute value, of the cosines between the normals and the triangle's normal
    - absolute triple product of the normals

    With fewer than three touches all values are 0.
    """
    index = np.array(list(combinations(range(points.shape[1]), 3)), dtype=np.int64).reshape(-1, 3)
    corners, own = points[:, index], normals[:, index]
    edges = np.roll(corners, -1, axis=2) - corners
    sides = np.sort(np.linalg.norm(edges, axis=-1), axis=-1)
    across = np.cross(edges[:, :, 0], edges[:, :, 1])
    double = np.linalg.norm(across, axis=-1, keepdims=True)
    facing = np.einsum("sptk,spk->spt", own, across / np.maximum(double, LEAST_SIZE))
    product = np.einsum("spk,spk->sp", np.cross(own[:, :, 0], own[:, :, 1]), own[:, :, 2])
    cosines = [np.abs(facing.mean(axis=-1)), np.abs(facing).mean(axis=-1), np.abs(product)]
    coordinates = np.concatenate([sides, np.stack(cosines, axis=-1)], axis=-1)
    described = statistics(np.concatenate([coordinates, double / 2], axis=-1))
    return np.concatenate([described, embed(coordinates, waves)], axis=1)
