"""Pads that are pressed on a plane, an edge, a cylinder and a sphere, and where their taxels' rays meet these shapes."""

import numpy as np
import trimesh

import visuohaptic as vh
from visuohaptic.geometry.pads import layout_of

WIDTH, ABOVE = 12.0, 4.0
"""Width of the pads and height from which the rays of flat pads start, in the unit of the meshes."""

SECTIONS = 720
PRESETS = ("square", "round", "dome", "finger", "gripper")
SHAPES = ("plane", "edge", "cylinder", "sphere")


def convex(normals, offsets, starts, directions):
    """First hit of rays with the solid of all points with normal · point <= offset."""
    along, outside = directions @ normals.T, offsets - starts @ normals.T
    with np.errstate(divide="ignore", invalid="ignore"):
        times = outside / along
    enter = np.where(along < 0, times, -np.inf)
    leave = np.where(along > 0, times, np.inf)
    misses = (enter.max(axis=1) > leave.min(axis=1)) | ((along == 0) & (outside < 0)).any(axis=1)
    return np.where(misses, np.inf, enter.max(axis=1)), normals[enter.argmax(axis=1)]


def round_solid(centre, radius, axes, starts, directions):
    """First hit with a sphere, `axes` (1, 1, 1), or a cylinder, with 0 along its axis."""
    apart, looks = (starts - centre) * axes, directions * axes
    a, b = (looks**2).sum(axis=1), (apart * looks).sum(axis=1)
    inside = b**2 - a * ((apart**2).sum(axis=1) - radius**2)
    times = np.where(inside >= 0, (-b - np.sqrt(np.maximum(inside, 0))) / a, np.inf)
    normals = (apart + np.where(np.isfinite(times), times, 0)[:, None] * looks) / radius
    return times, normals


def scene(shape, preset):
    """Mesh in the pad's frame, its exact first hit, and the largest distance between mesh and shape."""
    is_gripper = preset == "gripper"
    # Before a pad, slightly aside; between the pads of a gripper.
    size, top = (2.5, 5.0) if is_gripper else (30.0, -0.3)
    if shape in ("plane", "edge"):
        turn = 0.1 if shape == "plane" else np.pi / 4
        matrix = trimesh.transformations.rotation_matrix(turn, [1, 0.2, 0])
        mesh = trimesh.creation.box((2 * size, 2 * size, 2 * size))
        mesh.apply_transform(matrix)
        mesh.apply_translation([0.3, 0.2, top - mesh.bounds[1, 2]])
        centre = mesh.bounds.mean(axis=0)
        normals = np.concatenate([matrix[:3, :3].T, -matrix[:3, :3].T])
        return mesh, lambda *rays: convex(normals, normals @ centre + size, *rays), 1e-13 * size
    centre = np.array([0.3, 0.2, top - size])
    if shape == "sphere":
        mesh, axes = trimesh.creation.icosphere(6, radius=size), np.ones(3)
        # Edges of the icosphere are up to 0.0216 radii long, so faces are up to edge² / 6 deep.
        deep = size * 0.0216**2 / 6
    else:
        mesh, axes = trimesh.creation.cylinder(size, 200.0, SECTIONS), np.array([1.0, 0, 1])
        mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0]))
        deep = size * (1 - np.cos(np.pi / SECTIONS))
    mesh.apply_translation(centre)
    return mesh, lambda *rays: round_solid(centre, size, axes, *rays), deep + 1e-13 * size


def errors(preset, shape, seed=0):
    """Return |error| of each height along the normal of the shape, and the distance of mesh and shape.

    The pad stands at a random pose, and the shape with it. Rays within 3 degrees of grazing are left out.
    """
    layout = layout_of(preset, 16)
    mesh, first_hit, deep = scene(shape, preset)
    pose = trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3))
    pose[:3, 3] = np.random.default_rng(seed).normal(size=3)
    mesh.apply_transform(pose)
    felt = vh.press(mesh, poses=[pose], layout=layout, size=WIDTH, above=ABOVE)
    lift = min(ABOVE, layout.body * WIDTH / 2)
    starts = WIDTH / 2 * layout.positions - lift * layout.directions
    times, normals = first_hit(starts, layout.directions)
    expected = np.where(times >= 0, lift - times, -np.inf)
    steep = np.abs((layout.directions * normals).sum(axis=1))
    sure = ~np.isfinite(expected) | (steep > 0.05)
    found, expected, steep = felt.heights.ravel()[sure], expected[sure], steep[sure]
    np.testing.assert_array_equal(np.isfinite(found), np.isfinite(expected))
    met = np.isfinite(expected)
    assert met.sum() > len(met) / 8
    return np.abs(found[met] - expected[met]) * steep[met], deep
