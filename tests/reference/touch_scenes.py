"""Small scenes of many kinds, as vertices and triangles, and places to touch on them.

Meshes are made here, without the package. Where a scene states places, they are in the object frame that `vh.load`
makes: the centroid of the surface is the origin and the farthest vertex has distance 1.
"""

import numpy as np


def box(size, centre=(0, 0, 0)):
    """Return a box with the given edges; each of its six faces is two triangles."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    faces = np.array([
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ])  # fmt: skip
    return corners * np.array(size, float) + np.array(centre, float), faces


def joined(*parts):
    """Return all parts as one mesh."""
    vertices, faces, count = [], [], 0
    for part_vertices, part_faces in parts:
        vertices.append(part_vertices)
        faces.append(part_faces + count)
        count += len(part_vertices)
    return np.concatenate(vertices), np.concatenate(faces)


def turned(part, degrees, axis):
    """Turn a mesh about an axis through the origin, by Rodrigues' formula."""
    axis = np.array(axis, float) / np.linalg.norm(axis)
    angle = np.radians(degrees)
    vertices = part[0]
    along = np.outer(vertices @ axis, axis)
    return along + np.cos(angle) * (vertices - along) + np.sin(angle) * np.cross(
        axis, vertices
    ), part[1]


def grid(rows, columns, around=False, along=False):
    """Return the triangles of a grid of vertices that is closed in either way, or open."""
    faces = []
    for i in range(rows if around else rows - 1):
        for j in range(columns if along else columns - 1):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            c, d = (i + 1) % rows * columns + j, (i + 1) % rows * columns + (j + 1) % columns
            faces += [[a, c, d], [a, d, b]]
    return np.array(faces)


def revolved(profile, count=24):
    """Return the surface of revolution about y of a profile of (radius, height)."""
    vertices = []
    for turn in range(count):
        angle = 2 * np.pi * turn / count
        for radius, height in profile:
            vertices.append([radius * np.cos(angle), height, radius * np.sin(angle)])
    return np.array(vertices), grid(count, len(profile), around=True)


def ball(radius=1.0, rings=11, count=18):
    """Return a ball; its poles are small circles with a cap, so that no triangle is empty."""
    angles = np.linspace(0.02, np.pi - 0.02, rings)
    return revolved([(radius * np.sin(a), -radius * np.cos(a)) for a in angles], count)


def torus(large=1.0, small=0.35, count=20, sides=12):
    """Return a torus about y."""
    vertices = []
    for turn in range(count):
        for side in range(sides):
            a, b = 2 * np.pi * turn / count, 2 * np.pi * side / sides
            reach = large + small * np.cos(b)
            vertices.append([reach * np.cos(a), small * np.sin(b), reach * np.sin(a)])
    return np.array(vertices), grid(count, sides, around=True, along=True)


def cup(inner=0.5, outer=0.56, height=1.2, floor=0.08, count=24):
    """Return a cup: open at the top, with a wall and a floor."""
    centre = 1e-3
    return revolved(
        [
            (centre, 0),
            (outer, 0),
            (outer, height),
            (inner, height),
            (inner, floor),
            (centre, floor),
        ],
        count,
    )


def grooved(width, depth=0.15, length=1.0):
    """Return a block with a groove along z in its upper face."""
    side = (1 - width) / 2
    profile = [(-0.5, -0.5), (-0.5, 0.2), (-0.5 + side, 0.2), (-0.5 + side, 0.2 - depth)]
    profile += [(-x, y) for x, y in profile[::-1]]
    vertices = np.array([[x, y, z] for z in (-length / 2, length / 2) for x, y in profile])
    around = grid(2, len(profile), along=True)
    # Both ends are cut into the block below the groove's floor and the two flanks.
    ends = []
    for start, turn in ((0, 1), (len(profile), -1)):
        a, b, c, d, e, f, g, h = range(start, start + 8)
        for triangle in ([a, d, e], [a, e, h], [a, b, c], [a, c, d], [h, e, f], [h, f, g]):
            ends += [triangle[::turn]]
    return vertices, np.concatenate([around, np.array(ends)])


def relief(height, waves, count=17):
    """Return a sheet with waves along both axes."""
    side = np.linspace(-1, 1, count)
    vertices = [
        [x, height * np.sin(waves * x) * np.cos(waves * 0.7 * z), z] for x in side for z in side
    ]
    return np.array(vertices), grid(count, count)


def spike(radius, height):
    """Return a plate with a thin pyramid on it."""
    plate = box((2, 0.1, 2), (0, -0.05, 0))
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]]) * radius
    vertices = np.concatenate([corners, [[0, height, 0]]])
    faces = np.array([[0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]])
    return joined(plate, (vertices, faces))


def scenes():
    """Return the scenes by name."""
    return {
        "cube": box((1, 1, 1)),
        "turned cube": turned(box((1, 1, 1)), 33, (0.3, 1, 0.2)),
        "ball": ball(),
        "torus": torus(),
        "thin plate": box((1, 0.004, 0.7)),
        "narrow groove": grooved(0.03),
        "wide groove": grooved(0.22),
        "spike": spike(0.03, 0.4),
        "needle": spike(0.004, 0.3),
        "two boxes": joined(box((1, 1, 1)), box((1, 1, 1), (1.15, 0.1, 0.05))),
        "plate over plate": joined(box((1, 0.1, 1)), box((1, 0.1, 1), (0.05, 0.35, 0.03))),
        "close plates": joined(box((1, 0.1, 1)), box((1, 0.1, 1), (0.3, 0.115, 0.2))),
        "cup": cup(),
        "narrow cup": cup(inner=0.08, outer=0.12, height=0.8),
        "fine relief": relief(0.0015, 30),
        "waves": relief(0.06, 9),
        "deep waves": relief(0.25, 7),
        "flat relief": relief(0.00004, 9),
        "steps": joined(
            box((1, 0.1, 1)),
            box((0.5, 0.04, 1), (0.2, 0.06, 0)),
            box((0.2, 0.01, 1), (0.1, 0.083, 0)),
        ),
        "leaning wall": joined(
            box((2, 0.1, 2)), turned(box((0.05, 1, 1), (0.1, 0.45, 0)), 40, (0, 0, 1))
        ),
        # A wire that is thinner than the smallest cells: only the ray at the centre meets the wire.
        "wire over plate": joined(box((1, 0.1, 1)), box((0.0008, 0.0008, 1), (0.01, 0.25, 0))),
        "shells": joined(*(box((edge,) * 3) for edge in (1, 0.96, 0.91, 0.87, 0.82))),
        "blade": turned(box((1, 0.6, 0.01)), 20, (1, 0.4, 0.2)),
    }
