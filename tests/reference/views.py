"""A view by brute force: every ray is tried against every triangle.

Written from docs/method.md, docs/attention.md, docs/stability.md and the cited papers; rules that the pages leave out
stand here. Lengths are in object radii, all arrays are float64.
"""

from dataclasses import dataclass

import numpy as np

FIELD_OF_VIEW_DEGREES = 40.0  # docs/method.md: from the top to the bottom edge
LIGHT_DEGREES = 25.0  # docs/method.md: the light stands 25 degrees above the viewing axis
CREASE_DEGREES = (
    40.0  # docs/attention.md: facets that meet at less than 40 degrees are one smooth surface
)
FOLD_SPREAD = 0.03  # docs/attention.md: a fold is spread over 0.03 object radii


def to_object_frame(vertices, faces):
    """Return vertices with the surface's centroid at the origin and the farthest of them at distance 1."""
    total, mass = np.zeros(3), 0.0
    for a, b, c in vertices[faces]:
        area = np.linalg.norm(np.cross(b - a, c - a)) / 2
        total += area * (a + b + c) / 3
        mass += area
    centred = vertices - total / mass
    return centred / max(np.linalg.norm(vertex) for vertex in centred)


def ring_of_eyes(count, elevation_degrees, distance):
    """Return camera centres (count, 3) on one ring: the first in front (+z), the others around the y axis."""
    eyes = []
    elevation = np.radians(elevation_degrees)
    for index in range(count):
        azimuth = 2 * np.pi * index / count
        eyes.append(
            [
                distance * np.cos(elevation) * np.sin(azimuth),
                distance * np.sin(elevation),
                distance * np.cos(elevation) * np.cos(azimuth),
            ]
        )
    return np.array(eyes)


def camera_axes(eye):
    """Return the unit vectors right, up and backwards (towards the camera) of a camera that looks at the origin."""
    backward = eye / np.sqrt(eye @ eye)
    right = np.cross([0.0, 1.0, 0.0], backward)
    right = right / np.sqrt(right @ right)
    up = np.cross(backward, right)
    return right, up, backward


def pixel_ray(eye, row, column, size):
    """Return the direction of the ray through a pixel's centre, of length 1 along the viewing axis; row 0 is on top."""
    right, up, backward = camera_axes(eye)
    half_edge = np.tan(np.radians(FIELD_OF_VIEW_DEGREES) / 2)
    x = (2 * (column + 0.5) / size - 1) * half_edge
    y = (1 - 2 * (row + 0.5) / size) * half_edge
    return x * right + y * up - backward


def hit_triangles(origin, direction, a, b, c):
    """Return how far (f,), in lengths of the direction, a ray meets each triangle; infinite for a miss.

    Moeller & Trumbore 1997, J. Graphics Tools 2(1): the triangles' corners are a, b and c (f, 3). The second result
    has the corners' weights (f, 3) at the hits.
    """
    edge1, edge2 = b - a, c - a
    p = np.cross(direction, edge2)
    determinant = np.einsum("fk,fk->f", edge1, p)
    parallel = np.abs(determinant) < 1e-14
    determinant = np.where(parallel, 1.0, determinant)
    to_origin = origin - a
    u = np.einsum("fk,fk->f", to_origin, p) / determinant
    q = np.cross(to_origin, edge1)
    v = (q @ direction) / determinant
    distance = np.einsum("fk,fk->f", edge2, q) / determinant
    inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0) & ~parallel
    return np.where(inside, distance, np.inf), np.stack([1 - u - v, u, v], axis=1)


@dataclass
class View:
    """One view of n rows and columns; on the background everything but the colour is 0, face -1, depth infinite."""

    mask: np.ndarray  # (n, n), bool
    face: np.ndarray  # (n, n)
    depth: np.ndarray  # (n, n), along the viewing axis
    point: np.ndarray  # (n, n, 3)
    normal: np.ndarray  # (n, n, 3)
    colour: np.ndarray  # (n, n, 3), sRGB
    curvature: np.ndarray  # (n, n)
    ties: np.ndarray  # (n, n), bool: more than one face within 1e-9 of the nearest hit


def decode_srgb(value):
    """Return linear light from sRGB in 0 to 1 (IEC 61966-2-1)."""
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def encode_srgb(light):
    """Return sRGB from linear light in 0 to 1 (IEC 61966-2-1)."""
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)


def cross(first, second):
    """Return the cross product of two vectors; np.cross is for arrays of many."""
    (a, b, c), (u, v, w) = first.tolist(), second.tolist()
    return np.array([b * w - c * v, c * u - a * w, a * v - b * u])


def unit(vector):
    """Return a vector of length 1, or the zero vector."""
    length = np.sqrt(vector @ vector)
    return vector / length if length > 0 else vector


def face_normal(corners):
    """Return the unit normal of a triangle (3, 3) on the side from which its corners turn to the left."""
    return unit(cross(corners[1] - corners[0], corners[2] - corners[0]))


def light_direction(eye):
    """Return the unit vector towards the light, 25 degrees above the viewing axis."""
    _, up, backward = camera_axes(eye)
    angle = np.radians(LIGHT_DEGREES)
    return np.cos(angle) * backward + np.sin(angle) * up


def shade(colour, normal, eye, ambient):
    """Return the sRGB colour of a face in light: its linear light times ambient + (1 - ambient) max(0, n l)."""
    lambert = max(0.0, normal @ light_direction(eye))
    return encode_srgb(decode_srgb(colour) * (ambient + (1 - ambient) * lambert))


def angle_between(first, second):
    """Return the angle between two vectors, radians."""
    normal = cross(first, second)
    return np.arctan2(np.sqrt(normal @ normal), first @ second)


def neighbours(faces):
    """Return (face, edge, other face, other edge, aligned) of each edge of two faces; edge k joins corners k, k + 1.

    `aligned`: both faces run along the edge in opposite directions, so their normals are on the same side.
    """
    sharing = {}
    for face in range(len(faces)):
        for edge in range(3):
            ends = frozenset([faces[face, edge], faces[face, (edge + 1) % 3]])
            sharing.setdefault(ends, []).append((face, edge))
    pairs = []
    for members in sharing.values():
        if len(members) == 2:
            (face, edge), (other, k) = members
            pairs.append((face, edge, other, k, faces[face, edge] != faces[other, k]))
    return pairs


@dataclass
class Shape:
    """Normals and curvature at the corners, and the folds, of f faces; normals and curvature of seen faces only."""

    normals: np.ndarray  # (f, 3, 3), unit normal at each corner, on the side of the face's winding
    curvedness: np.ndarray  # (f, 3), of the smooth surface at each corner
    folds: np.ndarray  # (f, 3), fold angle on each edge, radians; 0 on smooth and free edges
    heights: np.ndarray  # (f, 3), distance of each edge from the opposite corner


def measure_shape(vertices, faces, seen):
    """Compute normals and curvature of the seen faces of a mesh without slivers and edges of more than two faces.

    docs/attention.md, "Curvature of any triangle mesh". Vertices at the same position count as one.
    """
    positions = {}
    for vertex in vertices:
        positions.setdefault(tuple(vertex), len(positions))
    welded = np.array([[positions[tuple(vertices[v])] for v in face] for face in faces])
    corners = vertices[faces]
    flat = np.array([face_normal(triangle) for triangle in corners])
    folds, groups = part_at_folds(welded, flat)

    # Curvature at a corner is a mean over faces around the corner, which takes the normals at all of their corners.
    of_seen = groups_of(seen, groups)
    around_seen = {face for members in of_seen for face, _, _ in members}
    normals = np.zeros((len(faces), 3, 3))
    for members in groups_of(around_seen, groups):
        # The mean of the faces' normals, weighted by the angle at the corner (Thuermer & Wuethrich 1998).
        total = np.zeros(3)
        for face, corner, side in members:
            here, onward, back = (corners[face, (corner + step) % 3] for step in range(3))
            total += side * angle_between(onward - here, back - here) * flat[face]
        for face, corner, side in members:
            normals[face, corner] = side * unit(total)

    a, b, c = corners.transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    of_face = np.zeros(len(faces))
    for face in around_seen:
        of_face[face] = curvedness_of_face(corners[face], normals[face])
    curvedness = np.zeros((len(faces), 3))
    for members in of_seen:
        around = [face for face, _, _ in members]
        mean = (areas[around] * of_face[around]).sum() / areas[around].sum()
        for face, corner, _ in members:
            curvedness[face, corner] = mean
    heights = np.zeros((len(faces), 3))
    for face in seen:
        for edge in range(3):
            side = corners[face, (edge + 1) % 3] - corners[face, edge]
            heights[face, edge] = 2 * areas[face] / np.linalg.norm(side)
    return Shape(normals, curvedness, folds, heights)


def groups_of(faces, groups):
    """Return the groups of corners in which any of the faces is."""
    return [members for members in groups if any(face in faces for face, _, _ in members)]


def part_at_folds(welded, flat):
    """Return the folds (f, 3), radians, and the groups of corners (face, corner, side) that smooth edges join.

    `side` is -1 for a face that is wound the other way, so that its normal is on the other side of the surface.
    """
    folds = np.zeros((len(welded), 3))
    links = {(face, corner): [] for face in range(len(welded)) for corner in range(3)}
    for face, edge, other, k, aligned in neighbours(welded):
        side = 1 if aligned else -1
        angle = angle_between(flat[face], side * flat[other])
        if angle > np.radians(CREASE_DEGREES):
            folds[face, edge] = folds[other, k] = angle
            continue
        for corner in (edge, (edge + 1) % 3):
            for opposite in (k, (k + 1) % 3):
                if welded[face, corner] == welded[other, opposite]:
                    links[face, corner].append((other, opposite, side))
                    links[other, opposite].append((face, corner, side))
    groups, grouped = [], set()
    for start in links:
        if start in grouped:
            continue
        sides, waiting = {start: 1}, [start]
        while waiting:
            here = waiting.pop()
            for other, opposite, side in links[here]:
                if (other, opposite) not in sides:
                    sides[other, opposite] = side * sides[here]
                    waiting.append((other, opposite))
        groups.append([(face, corner, side) for (face, corner), side in sides.items()])
        grouped.update(sides)
    return folds, groups


def curvedness_of_face(corners, normals):
    """Return the curvedness of a triangle (3, 3) with unit normals (3, 3) at its corners, at most 1 / FOLD_SPREAD.

    The shape operator maps steps on the face to turns of the normal (Rusinkiewicz 2004). Curvedness is the root mean
    square of the principal curvatures (Koenderink & van Doorn 1992).
    """
    a, b, c = corners
    tangent = unit(b - a)
    basis = np.array([tangent, cross(face_normal(corners), tangent)])
    steps = np.stack([basis @ (b - a), basis @ (c - a)], axis=1)
    turns = np.stack([basis @ (normals[1] - normals[0]), basis @ (normals[2] - normals[0])], axis=1)
    operator = turns @ np.linalg.inv(steps)
    principal = np.linalg.eigvalsh((operator + operator.T) / 2)
    return min(np.sqrt((principal**2).mean()), 1 / FOLD_SPREAD)


def curvature_at(shape, face, weights):
    """Return the curvedness at a point of a face, folds included.

    A fold has half its angle per unit of length (Cohen-Steiner & Morvan 2003). Each of its two faces has half of
    that, spread over FOLD_SPREAD from the edge and falling off linearly.
    """
    total = weights @ shape.curvedness[face]
    for edge in range(3):
        height = shape.heights[face, edge]
        distance = weights[(edge + 2) % 3] * height
        tent = max(0.0, 1 - distance / FOLD_SPREAD)
        if shape.folds[face, edge] == 0 or tent == 0:
            continue
        # The triangle narrows to its opposite corner: at distance d from the edge its width is 1 - d / height. So a
        # unit of the edge has this integral of the tent over the triangle (Simpson's rule, exact for cubics).
        end = min(height, FOLD_SPREAD)
        at = np.array([0, end / 2, end])
        integral = ((1 - at / height) * (1 - at / FOLD_SPREAD) * [1, 4, 1]).sum() * end / 6
        total += tent * shape.folds[face, edge] / 4 / integral
    return min(total, 3 / FOLD_SPREAD)


def render(vertices, faces, face_colours, eye, size, ambient=0.4, background=0.85):
    """Return the `View` of a mesh whose faces have sRGB colours (f, 3) from 0 to 1."""
    triangles = vertices[faces]
    backward = camera_axes(eye)[2]
    view = View(
        mask=np.zeros((size, size), bool),
        face=np.full((size, size), -1),
        depth=np.full((size, size), np.inf),
        point=np.zeros((size, size, 3)),
        normal=np.zeros((size, size, 3)),
        colour=np.full((size, size, 3), background),
        curvature=np.zeros((size, size)),
        ties=np.zeros((size, size), bool),
    )
    hits = {}
    for row in range(size):
        for column in range(size):
            direction = pixel_ray(eye, row, column, size)
            distances, weights = hit_triangles(eye, direction, *triangles.transpose(1, 0, 2))
            face = int(distances.argmin())
            if np.isinf(distances[face]):
                continue
            view.mask[row, column] = True
            view.ties[row, column] = (distances < distances[face] + 1e-9).sum() > 1
            hits[row, column] = direction, face, distances[face], weights[face]
    shape = measure_shape(vertices, faces, {face for _, face, _, _ in hits.values()})
    for pixel, (direction, face, distance, weights) in hits.items():
        point = eye + distance * direction
        # The interpolated normal, on the side of the camera; the face's own where that one points away.
        away = -1 if face_normal(triangles[face]) @ direction > 0 else 1
        normal = away * unit(weights @ shape.normals[face])
        if normal @ direction >= 0:
            normal = away * face_normal(triangles[face])
        view.face[pixel] = face
        view.depth[pixel] = (eye - point) @ backward
        view.point[pixel] = point
        view.normal[pixel] = normal
        view.colour[pixel] = shade(face_colours[face], normal, eye, ambient)
        view.curvature[pixel] = curvature_at(shape, face, weights)
    return view


def seen_light(image, corners, triangle, eye, row, column, size, samples=16):
    """Return the mean linear light (3,) of the part of an image that a pixel covers, by samples of the pixel.

    `image` (h, w, 3) has sRGB from 0 to 1 with the upper row first and is repeated beyond its edges. `corners` (3, 2)
    are its coordinates at the corners of the triangle: (0, 0) is its lower left, (1, 1) its upper right.
    """
    rows, columns = image.shape[:2]
    total = np.zeros(3)
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    for down in range(samples):
        for across in range(samples):
            offset_row = row + (down + 0.5) / samples - 0.5
            offset_column = column + (across + 0.5) / samples - 0.5
            direction = pixel_ray(eye, offset_row, offset_column, size)
            # Where the ray meets the plane of the triangle, in corners' weights.
            point = eye + direction * ((triangle[0] - eye) @ normal) / (direction @ normal)
            second = np.cross(triangle[2] - triangle[0], normal)
            third = np.cross(triangle[1] - triangle[0], normal)
            step = point - triangle[0]
            b = (step @ second) / ((triangle[1] - triangle[0]) @ second)
            c = (step @ third) / ((triangle[2] - triangle[0]) @ third)
            u, v = (1 - b - c) * corners[0] + b * corners[1] + c * corners[2]
            texel = image[
                int(np.floor((1 - v) * rows)) % rows, int(np.floor(u * columns)) % columns
            ]
            total += decode_srgb(texel)
    return total / samples**2
