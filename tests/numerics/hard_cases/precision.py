"""Imprints, frames and spheres against closed forms."""

import numpy as np
from numerics.surfaces import ball, build_plain_surface, float32_exact, pick
from numerics.tolerances import U32

from visuohaptic.geometry.curvature import unit_vectors
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.example_shapes import sheet
from visuohaptic.sensor.frames import column_axes, row_axes
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.sensing import touch
from visuohaptic.stability.findings import Finding

ABSOLUTE = SensorParameters(normalisation="absolute", normal="given", largest_size=0.2)
RIGID = Scene()


def press(surface, point, normal, **changes):
    """Touch a point; give what is felt, and how far to the right and down the sensing points lie."""
    parameters = ABSOLUTE.model_copy(update=changes)
    places, normals = (np.array([vector], dtype=float) for vector in (point, normal))
    felt = touch(RayCaster(surface), places, normals, parameters, RIGID)
    steps = (np.arange(parameters.resolution) + 0.5) / parameters.resolution - 0.5
    return felt, *np.meshgrid(felt.size[0] * steps, felt.size[0] * steps)


def wall(slope_right, slope_up):
    """Return z = height(x, y) as a tilted wall that faces +z, and the height over x and y down."""

    def height(x, down):
        return slope_right * x - slope_up * down

    flat = sheet(height, half=0.5, cells=16)
    x, y, z = flat.vertices.T
    # Turn the sheet's up to +z: x stays, what ran along z runs down.
    return float32_exact(build_plain_surface(np.column_stack([x, -z, y]), flat.faces)), height


def tilted_walls(generator):
    """Touch a tilted wall, and compare the imprint with the plane in closed form."""
    right, up = pick(generator, -0.4, 0.4), pick(generator, -0.4, 0.4)
    surface, height = wall(right, up)
    felt, across, down = press(surface, (0, 0, 0), (0, 0, 1))
    expected = height(across, down)
    gaps = np.clip(expected, 0, 0.1).max() - expected
    wanted = 1 - np.clip(gaps / ABSOLUTE.depth_range, 0, 1)
    error = np.abs(felt.images[0] - wanted).max()
    label = f"a wall of slopes {right:.2f} to the right and {up:.2f} upwards"
    yield Finding("precision/imprint of a plane in closed form", error, label)


def frames(generator):
    """Stand frames on normals, axes among them: they are square and right-handed."""
    normals = generator.normal(size=(200, 3))
    normals[:40] = np.rint(normals[:40])
    normals = unit_vectors(normals[np.linalg.norm(normals, axis=1) > 0])
    for orientation in ("upright", "transported"):
        columns = column_axes(normals, orientation)
        # Rows run downwards seen from outside, so columns × rows point into the object.
        frame = np.stack([columns, -row_axes(normals, columns), normals], axis=1)
        square = np.abs(np.einsum("nij,nkj->nik", frame, frame) - np.eye(3)).max(axis=(1, 2))
        errors = np.maximum(square, np.abs(np.linalg.det(frame) - 1))
        label = f"{orientation}, random normals and axes"
        yield Finding("precision/frames on the surface", errors, label)


def tessellated_spheres(generator):
    """Cast rays at a ball of triangles: it comes near a sphere by the square of its edge."""
    surface = ball(int(generator.integers(2, 5)))
    directions = unit_vectors(generator.normal(size=(2000, 3)))
    hits = RayCaster(surface).first_hits(2 * directions, -directions)
    corners = surface.triangles
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    # The middle of an even triangle of edge e with its corners on the unit sphere.
    deepest = 1 - np.sqrt(1 - edge**2 / 3)
    errors = (np.abs(hits.distance - 1) - 4 * U32) / deepest
    yield Finding("precision/tessellated sphere", errors, f"{len(surface.faces)} faces")


def pressed_spheres(generator):
    """Touch a fine ball on its top, and compare the gaps with the sphere's."""
    resolution = int(generator.choice([8, 32, 64]))
    surface = ball(6)
    corner = surface.vertices[np.argmax(surface.vertices[:, 1])]
    normal = corner / np.linalg.norm(corner)
    felt, across, down = press(surface, corner, normal, resolution=resolution)
    depth = 1 - np.sqrt(1 - np.hypot(across, down) ** 2)
    error = np.abs(felt.gaps[0] - depth).max()
    label = f"{resolution} × {resolution} sensing points, {len(surface.faces):,} faces"
    yield Finding("precision/sphere under the sensor", error, label)


def out_of_reach(generator):
    """Touch a ball smaller than the sensor: what is not met is 0, the rest is within 0 and 1."""
    radius = pick(generator, 0.03, 0.09)
    surface = ball(4, radius)
    top = (0, surface.vertices[:, 1].max(), 0)
    felt, across, down = press(surface, top, (0, 1, 0), depth_range=0.5 * radius)
    beyond = np.hypot(across, down) > np.sqrt(0.75) * radius * 1.02
    image = felt.images[0]
    wrong = np.where(beyond, image != 0, ~((image >= 0) & (image <= 1))).any()
    label = f"a ball of radius {radius:.3f} under a square of {felt.size[0]:.2f}"
    yield Finding("precision/values out of reach and beyond full scale", wrong, label)
