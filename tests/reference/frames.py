"""Descriptors of poses for frames that know less than the whole pose, as `docs/recognition.md` lists them, with loops."""

import itertools
import math

import numpy as np
from reference.recognition import SHORTEST, four_statistics, pair_relations

AXES = (0, 2)
"""Coordinates x and z, which lie level."""


def length(vector):
    return math.sqrt(sum(value**2 for value in vector))


def direction(vector):
    return [value / max(length(vector), SHORTEST) for value in vector]


def product(first, second):
    return sum(one * other for one, other in zip(first, second, strict=True))


def pair_features(touches, first, second):
    """Return the unit vector from one point to the other, and n₁·e, n₂·e, n₁·n₂ (Drost et al. 2010)."""
    (start, normal), (end, other) = touches[first], touches[second]
    along = direction(end - start)
    return along, product(normal, along), product(other, along), product(normal, other)


def around_axis(point, normal):
    """Return a, y and the cosines of the normal to the radial, vertical and tangential direction."""
    (x, z), (normal_x, normal_z) = direction([point[i] for i in AXES]), (normal[0], normal[2])
    radial, around = x * normal_x + z * normal_z, abs(x * normal_z - z * normal_x)
    return [length([point[i] for i in AXES]), point[1], radial, normal[1], around]


def around_centre(point, normal):
    """Return |p| and p·n / |p|."""
    return [length(point), product(direction(point), normal)]


def each_touch(frame, touches):
    if frame == "none":
        return []
    rows = [around_centre(*touch) for touch in touches]
    if frame == "vertical":
        rows = [
            [*around_axis(*touch), *central]
            for touch, central in zip(touches, rows, strict=True)
        ]  # fmt: skip
    return four_statistics(rows)


def rigid_relations(touches):
    rows = []
    for first, second in itertools.combinations(range(len(touches)), 2):
        along, leaving, arriving, agreement = pair_features(touches, first, second)
        triple = product(np.cross(touches[first][1], touches[second][1]), along)
        distance = length(touches[second][0] - touches[first][0])
        rows.append([distance, agreement, arriving - leaving, abs(arriving + leaving), abs(triple)])
    extents = pair_relations(*map(np.array, zip(*touches, strict=True)))[-3:]
    return (four_statistics(rows) if rows else [0.0] * 20) + extents


def relations(frame, touches):
    if frame == "none":
        return rigid_relations(touches)
    rows = []
    for (first, _), (second, _) in itertools.combinations(touches, 2):
        if frame == "centre":
            rows.append([product(direction(first), direction(second))])
            continue
        (x, z), (other_x, other_z) = (
            direction([point[i] for i in AXES]) for point in (first, second)
        )
        sine = x * other_z - z * other_x
        rows.append([x * other_x + z * other_z, abs(sine), sine * (second[1] - first[1])])
    base = (
        rigid_relations(touches)
        if frame == "centre"
        else pair_relations(*map(np.array, zip(*touches, strict=True)))
    )
    return base + (four_statistics(rows) if rows else [0.0] * (4 if frame == "centre" else 12))


def mean_waves(rows, directions, phases):
    """Return √2 times the mean of cos(w·q + b) over the rows q, per wave; 0 without a row."""
    return [
        math.sqrt(2)
        * sum(math.cos(product(row, wave) + phase) for row in rows)
        / max(len(rows), 1)
        for wave, phase in zip(directions.T, phases, strict=True)
    ]  # fmt: skip


def embedding(frame, touches, directions, phases):
    pairs = []
    for first, second in itertools.permutations(range(len(touches)), 2):
        start, end = touches[first][0], touches[second][0]
        step = end - start
        lengths = {
            "none": [length(step), 0.0, 0.0],
            "centre": [length(step), length(start), length(end)],
            "vertical": [length([step[i] for i in AXES]), start[1], end[1]],
        }[frame]
        pairs.append([*lengths, *pair_features(touches, first, second)[1:]])
    of_pairs = mean_waves(pairs, directions, phases)
    if frame == "none":
        return of_pairs
    rows = []
    for touch in touches:
        if frame == "centre":
            radius, outward = around_centre(*touch)
            rows.append([radius, 0.0, 0.0, outward, 0.0, 0.0])
        else:
            axial, height, *cosines = around_axis(*touch)
            rows.append([axial, height, 0.0, *cosines])
    return mean_waves(rows, directions, phases) + of_pairs


def descriptors(frame, points, normals, directions, phases):
    """Return groups `pose`, `relations` and `embedding` of a sequence of points and normals (t, 3)."""
    touches = list(zip(points, normals, strict=True))
    return (
        each_touch(frame, touches)
        + relations(frame, touches)
        + embedding(frame, touches, directions, phases)
    )
