"""Recorded points on a mesh: the scale and shift between them, and the surface where there is no mesh."""

from __future__ import annotations

from operator import itemgetter

import numpy as np
from scipy.spatial import cKDTree

from human_gaze.recordings import GazeError, Recording
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface

GREY = 200
RECONSTRUCTION_DEPTH = 8
# Parts of a reconstruction are left out where they are farther than this from every point, in units
# of the points' half extent, and farther than so many times the points' own spacing.
FARTHEST = 0.05
SPACINGS = 3.0
_REFINEMENTS = 2


def align(
    points: FloatArray, caster: RayCaster, name: str, largest_error: float
) -> tuple[FloatArray, float]:
    """Bring recorded points (n, 3), with the mesh's axes, to the surface by one scale and a shift.

    They come from the bounding boxes, refined by least squares to the nearest points. Gives these (n, 3), and
    the distance, mesh unit, that 95 % keep within. Raises `GazeError`, with the recording's `name`, if the
    points have no extent, or that distance is above `largest_error`.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float(np.linalg.norm(high - low))
    if not extent > 0:
        raise GazeError(f"{name}: all recorded points are at one place; an extent is needed.")
    scale = float(np.linalg.norm(caster.bounds[1] - caster.bounds[0])) / extent
    shift = caster.bounds.mean(axis=0) - scale * 0.5 * (low + high)
    found: list[tuple[float, FloatArray]] = []
    for _ in range(1 + _REFINEMENTS):
        moved = scale * points + shift
        nearest, _ = caster.nearest(moved)
        distances = np.linalg.norm(moved - nearest, axis=1)
        found.append((float(np.percentile(distances, 95)), nearest))
        scale, shift = _fitted(points, nearest)
    error, nearest = min(found, key=itemgetter(0))
    if error > largest_error:
        raise GazeError(
            f"{name}: 5 % of the recorded points lie more than {error:.3f} object radii off the mesh, "
            f"{largest_error:g} is allowed; give the mesh the recording's axes, or the mesh that was "
            "shown."
        )
    return nearest, error


def reconstruct(recording: Recording) -> Surface:
    """Make a surface from a recording's points and normals, for one that has no mesh.

    Screened Poisson reconstruction (Kazhdan & Hoppe 2013, ACM Trans. Graph. 32(3)), without what lies far
    from every point. Raises `GazeError` where points or normals are missing.
    """
    from visuohaptic.geometry.compiled_open3d import open3d

    if recording.points is None or recording.normals is None:
        raise GazeError(
            f"{recording.name} has no mesh of its name, and no points with normals to make one from; "
            "put the mesh beside it."
        )
    low, high = recording.points.min(axis=0), recording.points.max(axis=0)
    half = 0.5 * float((high - low).max())
    if not half > 0:
        raise GazeError(f"{recording.name}: all recorded points are at one place.")
    points = (recording.points - 0.5 * (low + high)) / half
    vector = open3d.utility.Vector3dVector
    cloud = open3d.geometry.PointCloud(vector(points))
    cloud.normals = vector(recording.normals)
    made, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(
        cloud, depth=RECONSTRUCTION_DEPTH, n_threads=1
    )
    vertices, faces = np.asarray(made.vertices), np.asarray(made.triangles).astype(np.int64)
    tree = cKDTree(points)
    distance, _ = tree.query(vertices)
    spacing = float(np.median(tree.query(points, 2)[0][:, 1]))
    farthest = max(FARTHEST, SPACINGS * spacing)
    faces = faces[distance[faces].max(axis=1) < farthest] if len(faces) else faces
    if not len(faces):
        raise GazeError(f"{recording.name}: no surface can be made from its points; give a mesh.")
    return grey_surface(vertices, faces)


def grey_surface(vertices: FloatArray, faces: IntArray) -> Surface:
    """Give a surface without colour, as people saw these objects."""
    return Surface(vertices, faces, np.full((len(faces), 3), GREY, dtype=np.uint8))


def _fitted(points: FloatArray, nearest: FloatArray) -> tuple[float, FloatArray]:
    """Give the scale and shift that bring points closest to others, by least squares."""
    middle, other = points.mean(axis=0), nearest.mean(axis=0)
    centred = points - middle
    scale = float((centred * (nearest - other)).sum() / (centred**2).sum())
    return scale, other - scale * middle
