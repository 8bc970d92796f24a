"""Align recorded points with a mesh by scale and shift, and reconstruct a surface without a mesh."""

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
# A face of a reconstruction is left out if a corner is farther from all points than FARTHEST, in units of half of the
# points' extent, and than SPACINGS times the median spacing of the points.
FARTHEST = 0.05
SPACINGS = 3.0
_REFINEMENTS = 2


def align(
    points: FloatArray, caster: RayCaster, name: str, largest_error: float
) -> tuple[FloatArray, float]:
    """Align recorded points with a surface by one scale and a shift.

    Scale and shift start from the bounding boxes, and are refined by least squares to the nearest points.

    Parameters
    ----------
    points : ndarray of shape (n, 3)
        Recorded points; their axes must be those of the mesh.
    caster : RayCaster
        The surface.
    name : str
        Name of the recording, for errors.
    largest_error : float
        Largest distance that is allowed, in units of the mesh.

    Returns
    -------
    nearest : ndarray of shape (n, 3)
        Point of the surface nearest to each aligned point.
    error : float
        Distance within which 95 % of the aligned points lie from the surface, in units of the mesh.

    Raises
    ------
    GazeError
        If the points have no extent, or the error is above `largest_error`.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float(np.linalg.norm(high - low))
    if not extent > 0:
        raise GazeError(
            f"{name}: all recorded points are equal; points over the whole object are needed."
        )
    scale = float(np.linalg.norm(caster.bounds[1] - caster.bounds[0])) / extent
    shift = caster.bounds.mean(axis=0) - scale * 0.5 * (low + high)
    candidates: list[tuple[float, FloatArray]] = []
    for _ in range(1 + _REFINEMENTS):
        moved = scale * points + shift
        nearest, _ = caster.nearest(moved)
        distances = np.linalg.norm(moved - nearest, axis=1)
        candidates.append((float(np.percentile(distances, 95)), nearest))
        scale, shift = _fitted(points, nearest)
    error, nearest = min(candidates, key=itemgetter(0))
    if error > largest_error:
        raise GazeError(
            f"{name}: 5 % of the recorded points lie more than {error:.3f} object radii off the mesh; "
            f"at most {largest_error:g} is allowed; give the mesh the recording's axes, or the mesh that was "
            "shown."
        )
    return nearest, error


def reconstruct(recording: Recording) -> Surface:
    """Reconstruct a surface from the points and normals of a recording that has no mesh.

    The method is screened Poisson reconstruction (Kazhdan & Hoppe 2013, ACM Trans. Graph. 32(3)). Faces far from all
    points are left out. Raises `GazeError` if points or normals are missing, or no face is left.
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
        raise GazeError(
            f"{recording.name}: all recorded points are equal; points over the whole object are needed."
        )
    points = (recording.points - 0.5 * (low + high)) / half
    vector = open3d.utility.Vector3dVector
    cloud = open3d.geometry.PointCloud(vector(points))
    cloud.normals = vector(recording.normals)
    mesh, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(
        cloud, depth=RECONSTRUCTION_DEPTH, n_threads=1
    )
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles).astype(np.int64)
    tree = cKDTree(points)
    distance, _ = tree.query(vertices)
    spacing = float(np.median(tree.query(points, 2)[0][:, 1]))
    farthest = max(FARTHEST, SPACINGS * spacing)
    faces = faces[distance[faces].max(axis=1) < farthest] if len(faces) else faces
    if not len(faces):
        raise GazeError(f"{recording.name}: no surface can be made from its points; give a mesh.")
    return grey_surface(vertices, faces)


def grey_surface(vertices: FloatArray, faces: IntArray) -> Surface:
    """Return a grey surface, because people saw the objects without colour."""
    return Surface(vertices, faces, np.full((len(faces), 3), GREY, dtype=np.uint8))


def _fitted(points: FloatArray, nearest: FloatArray) -> tuple[float, FloatArray]:
    """Compute the scale and shift that map points to their nearest points by least squares."""
    middle, target = points.mean(axis=0), nearest.mean(axis=0)
    centred = points - middle
    scale = float((centred * (nearest - target)).sum() / (centred**2).sum())
    return scale, target - scale * middle
