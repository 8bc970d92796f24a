"""The touches of the default experiment, once more: plain loops, written from the documentation.

Sources: section 3.2 of the paper (a square of sensing points on the tangent plane, distances to the object,
normalised to [0, 1], a square that shrinks until nothing penetrates), docs/sensor.md and docs/probing.md for
the choices that the paper leaves open, and T. Möller, B. Trumbore, "Fast, minimum storage ray-triangle
intersection", Journal of Graphics Tools 2(1), 1997, for the rays. This module imports nothing of the package
that it checks. Lengths are in object radii, and y points up.
"""

from dataclasses import dataclass

import numpy as np

TOLERANCE = 0.002  # height above the tangent plane that a square admits (docs/sensor.md, Size)
CLEARANCE = 0.1  # greatest height from which rays start below an obstacle (docs/sensor.md, Size)
LEAST_RELIEF = (
    0.0001  # relief that is stretched to the whole range of an image (docs/sensor.md, Range)
)
STAND_OFF = 1e-5  # distance from the surface at which rays that look for the outside begin
STAND_CLEAR = 1e-9  # share of itself by which a square is smaller than its bound
PERIMETER_RAYS = 128  # rays that look for the largest admissible square (docs/sensor.md, Size)
PASSED_OVER = 16  # most places out of reach per sequence (docs/probing.md, Places out of reach)


@dataclass
class Sensor:
    """Section `sensor` of params.yaml with its defaults."""

    resolution: int = 32
    largest_size: float = 0.3
    smallest_size: float = 0.02
    depth_range: float = 0.1
    normalisation: str = "per_imprint"


@dataclass
class Touch:
    """One touch: `gaps` and `image` have one row per row of sensing points."""

    normal: np.ndarray
    column_axis: np.ndarray
    row_axis: np.ndarray
    size: float
    penetration: float
    gaps: np.ndarray
    image: np.ndarray
    state: str


# The sensor's frame (docs/sensor.md, Frame) -------------------------------------------------------------


def face_normal(corners, towards):
    """Compute the unit normal of a triangle, on the side to which `towards` points."""
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal = normal / np.sqrt(np.dot(normal, normal))
    if np.dot(normal, towards) < 0:
        return -normal
    return normal


def column_axis(normal):
    """Compute the +column axis of convention `upright`: y × n + n_y² x / 4, made tangent and of length 1."""
    up = np.array([0.0, 1.0, 0.0])
    right = np.array([1.0, 0.0, 0.0])
    axis = np.cross(up, normal) + normal[1] ** 2 * right / 4
    axis = axis - np.dot(axis, normal) * normal
    return axis / np.sqrt(np.dot(axis, axis))


def row_axis(normal, columns):
    """Compute the +row axis: seen from outside, columns run to the right and rows downwards."""
    upwards = np.cross(normal, columns)
    return -upwards


def sensing_offsets(size, resolution):
    """Return the offsets of the centres of equal cells: ±s/64, ±3s/64, … ±31s/64 for 32 cells."""
    return [(cell + 0.5) * size / resolution - size / 2 for cell in range(resolution)]


# Rays (Möller and Trumbore 1997), against every triangle ------------------------------------------------


def hits(origin, direction, triangles):
    """Compute where a line meets triangles, (n, 3, 3): distances in units of `direction`, and indices of triangles."""
    edge_1 = triangles[:, 1] - triangles[:, 0]
    edge_2 = triangles[:, 2] - triangles[:, 0]
    p = np.cross(direction, edge_2)
    determinant = (edge_1 * p).sum(axis=1)
    crossed = np.abs(determinant) > 1e-14 * np.sqrt((edge_1**2).sum(axis=1) * (p**2).sum(axis=1))
    edge_1, edge_2, p, determinant = (
        edge_1[crossed],
        edge_2[crossed],
        p[crossed],
        determinant[crossed],
    )
    s = origin - triangles[crossed, 0]
    q = np.cross(s, edge_1)
    u = (s * p).sum(axis=1) / determinant
    v = (q @ direction) / determinant
    t = (edge_2 * q).sum(axis=1) / determinant
    slack = 1e-12  # a ray at an edge meets both triangles
    inside = (u >= -slack) & (v >= -slack) & (u + v <= 1 + slack)
    return t[inside], np.flatnonzero(crossed)[inside]


def hit_distances(origin, direction, triangles):
    """Compute the distances at which a line meets triangles, (n, 3, 3), in units of `direction`."""
    return hits(origin, direction, triangles)[0]


def height_of_object(place, normal, triangles, below=np.inf):
    """Compute the height above `place` of the highest part under `below` that the line along the normal meets."""
    heights = hit_distances(place, normal, triangles)
    heights = heights[heights <= below]
    if len(heights) == 0:
        return -np.inf
    return heights.max()


def within_square(place, columns, rows, size, triangles):
    """Return the triangles that rays within the square along its normal or in its plane can meet."""
    return within_strip(place, rows, size, within_strip(place, columns, size, triangles))


def within_strip(place, axis, width, triangles):
    """Return the triangles of which a part is less than half a width away from the place along an axis."""
    offsets = (triangles - place) @ axis
    reach = width / 2 + 1e-9
    return triangles[(offsets.min(axis=1) <= reach) & (offsets.max(axis=1) >= -reach)]


def square_of_heights(place, normal, columns, rows, size, resolution, triangles, below=np.inf):
    """Compute the height of the object above the tangent plane at every sensing point of a square."""
    heights = np.empty((resolution, resolution))
    offsets = sensing_offsets(size, resolution)
    for i, down in enumerate(offsets):
        in_row = within_strip(place + down * rows, rows, 0, triangles)
        for j, right in enumerate(offsets):
            point = place + right * columns + down * rows
            heights[i, j] = height_of_object(point, normal, in_row, below)
    return heights


# Outside of a surface (docs/sensor.md, Frame, in numbers) -----------------------------------------------------------


def outward_normal(place, face, vertices, faces):
    """Return the unit normal of a face on the side from which a sensor can come, where no eye sees the place.

    The longer free way is outside. If both ways end, as in a gap, a side out of all solids wins against a side
    within a solid. If both ways are equal, as on a single sheet, outside is away from the origin.
    """
    triangles = vertices[faces]
    normal = face_normal(triangles[face], place)
    ways, solids = [], []
    for side in (normal, -normal):
        start = place + STAND_OFF * side
        met = hit_distances(start, side, triangles)
        ways.append(met[met > 0].min(initial=np.inf))
        solids.append(winding_number(start, side, triangles))
    before, behind = ways
    if before < np.inf and behind < np.inf and (solids[0] == 0) != (solids[1] == 0):
        return normal if solids[0] == 0 else -normal
    return -normal if behind > before else normal


def winding_number(origin, direction, triangles):
    """Count the faces that a ray leaves through, minus the faces through which the ray enters."""
    number = 0
    for distance, index in zip(*hits(origin, direction, triangles), strict=True):
        corners = triangles[index]
        winding = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        if distance > 0:
            number += 1 if np.dot(winding, direction) > 0 else -1
    return number


# Reach (docs/probing.md, Places out of reach) -----------------------------------------------------------


def height_of_obstacle(place, normal, triangles):
    """Compute the height of the first part above the tolerance that the line along the normal meets."""
    heights = hit_distances(place, normal, triangles)
    heights = heights[heights > TOLERANCE]
    if len(heights) == 0:
        return np.inf
    return heights.min()


def in_reach(place, face, towards, sensor, vertices, faces):
    """Return whether the smallest square meets nothing on its way along the normal before its centre touches.

    The parameters are those of `touch`. Rays at the centre and at the sensing points find parts that are higher
    than the tolerance above the tangent plane.
    """
    triangles = vertices[faces]
    normal = face_normal(triangles[face], towards)
    columns = column_axis(normal)
    rows = row_axis(normal, columns)
    near = within_square(place, columns, rows, sensor.smallest_size, triangles)
    if height_of_obstacle(place, normal, near) < np.inf:
        return False
    heights = square_of_heights(
        place, normal, columns, rows, sensor.smallest_size, sensor.resolution, near
    )
    return heights.max() <= TOLERANCE


def touched_places(reached, wanted=5):
    """Return the indices of the places that are touched: the first `wanted` in reach, with 16 passed over at most."""
    touched = []
    passed = 0
    for index, reachable in enumerate(reached):
        if len(touched) == wanted:
            break
        if reachable:
            touched.append(index)
            continue
        passed += 1
        if passed > PASSED_OVER:
            break
    return touched


# Adaptive size (docs/sensor.md, Size) -------------------------------------------------------------------


def perimeter(size):
    """Return 128 points at equal steps along the perimeter of a square, from a corner on."""
    points = []
    steps = PERIMETER_RAYS // 4
    half = size / 2
    for step in range(steps):
        along = -half + step * size / steps
        points.append((along, -half))
        points.append((half, along))
        points.append((-along, half))
        points.append((-half, -along))
    return points


def size_bound(place, normal, columns, rows, largest, triangles):
    """Compute the largest square without a hit, by rays in the plane that lies the tolerance above the tangent plane."""
    origin = place + TOLERANCE * normal
    bound = largest
    for right, down in perimeter(largest):
        # A hit at the share t of the way to the perimeter lies on the perimeter of the square of t times the size.
        shares = hit_distances(origin, right * columns + down * rows, triangles)
        shares = shares[shares > 0]
        if len(shares) > 0:
            bound = min(bound, shares.min() * largest * (1 - STAND_CLEAR))
    return bound


def nearest_penetrated(heights, size):
    """Return the edge of the square whose perimeter holds the nearest sensing point above the tolerance, or None."""
    offsets = sensing_offsets(size, len(heights))
    nearest = None
    for i, down in enumerate(offsets):
        for j, right in enumerate(offsets):
            if heights[i, j] > TOLERANCE:
                edge = 2 * max(abs(down), abs(right)) * (1 - STAND_CLEAR)
                if nearest is None or edge < nearest:
                    nearest = edge
    return nearest


# A touch ------------------------------------------------------------------------------------------------


def touch(place, face, towards, sensor, vertices, faces):
    """Touch an object in scene `ideal`.

    Parameters: the place, the index of its face, a direction on the side of the face from which the sensor
    comes, the sensor, vertices (v, 3) and faces (f, 3) of the object.
    """
    triangles = vertices[faces]
    normal = face_normal(triangles[face], towards)
    columns = column_axis(normal)
    rows = row_axis(normal, columns)
    near = within_square(place, columns, rows, sensor.largest_size, triangles)
    obstacle = height_of_obstacle(place, normal, near)
    start = np.inf
    if obstacle < np.inf:
        start = min(CLEARANCE, (TOLERANCE + obstacle) / 2)

    size = size_bound(place, normal, columns, rows, sensor.largest_size, near)
    size = max(size, sensor.smallest_size)
    while True:
        heights = square_of_heights(
            place, normal, columns, rows, size, sensor.resolution, near, start
        )
        edge = nearest_penetrated(heights, size)
        if edge is None or size == sensor.smallest_size:
            break
        size = max(edge, sensor.smallest_size)

    penetration = max(heights.max(), 0.0)
    gaps = min(penetration, CLEARANCE) - heights  # the sensor rests on the highest point
    return Touch(
        normal=normal,
        column_axis=columns,
        row_axis=rows,
        size=size,
        penetration=penetration,
        gaps=gaps,
        image=imprint(gaps, sensor),
        state=contact_state(obstacle, heights, size, sensor),
    )


def imprint(gaps, sensor):
    """Compute the image of gaps: 1 is contact, 0 is a gap of `depth_range` or more; then stretch to [0, 1]."""
    image = np.empty(gaps.shape)
    for i in range(gaps.shape[0]):
        for j in range(gaps.shape[1]):
            image[i, j] = 1 - min(max(gaps[i, j] / sensor.depth_range, 0.0), 1.0)
    if sensor.normalisation == "absolute":
        return image
    if image.max() == 0:
        return image
    relief = image.max() - image.min()
    least = LEAST_RELIEF / sensor.depth_range
    return 1 - (image.max() - image) / max(relief, least)


def contact_state(obstacle, heights, size, sensor):
    """Return the first state that holds (docs/sensor.md, Size)."""
    if obstacle < np.inf or heights.max() > CLEARANCE:
        return "blocked"
    if heights.max() > TOLERANCE:
        return "at_minimum"
    if heights.min() < -sensor.depth_range:
        return "partial"
    if size < sensor.largest_size:
        return "shrunk"
    return "full"
