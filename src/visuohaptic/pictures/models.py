"""Models with few enough faces to be rotated within a page."""

from __future__ import annotations

import gzip

import numpy as np
from numpy.typing import NDArray

from visuohaptic.geometry.surface import Surface

COORDINATE_STEPS = 16384
"""Steps per object radius; coordinates lie within the unit sphere."""


def thin(surface: Surface, faces: int) -> Surface:
    """Simplify a surface to about `faces` faces by quadric error decimation (Garland & Heckbert 1997).

    Each new face has the colour of the nearest face of `surface`. A surface with at most `faces` faces is returned
    unchanged.
    """
    if len(surface.faces) <= faces:
        return surface
    from visuohaptic.geometry.compiled_open3d import open3d

    mesh = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(surface.vertices),
        open3d.utility.Vector3iVector(surface.faces.astype(np.int32)),
    )
    simple = mesh.simplify_quadric_decimation(faces)
    vertices, corners = np.asarray(simple.vertices), np.asarray(simple.triangles).astype(np.int64)
    return Surface(vertices, corners, _nearest_colours(surface, vertices[corners].mean(axis=1)))


def pack_model(
    surface: Surface, touches: NDArray[np.float64], faces: int
) -> dict[str, bytes | int]:
    """Thin a model to about `faces` faces and pack it with its touches.

    Parameters
    ----------
    surface : Surface
        The model.
    touches : array (n, 10), float64
        Point, normal, column axis and size of each touch.
    faces : int
        The number of faces to keep.

    Returns
    -------
    dict
        Columns of `tables.PICTURES`. The unpacked bytes of ``model`` are, little-endian and in this order:
        ``vertices`` × 3 int16 coordinates in steps of 1 / `COORDINATE_STEPS`, ``touches`` × 10 int16 in the same
        steps, ``faces`` × 3 uint32 corners, ``faces`` × 3 uint8 sRGB.
    """
    thinned = thin(surface, faces)
    used, corners = np.unique(thinned.faces, return_inverse=True)
    blocks = (
        _steps(thinned.vertices[used]),
        _steps(touches),
        corners.astype("<u4"),
        thinned.face_colours.astype(np.uint8),
    )
    return {
        "model": gzip.compress(b"".join(block.tobytes() for block in blocks), 9, mtime=0),
        "vertices": len(used),
        "faces": len(thinned.faces),
        "touches": len(touches),
        "original_faces": len(surface.faces),
    }


def _steps(values: NDArray[np.float64]) -> NDArray[np.int16]:
    return np.rint(np.clip(values, -1.99, 1.99) * COORDINATE_STEPS).astype("<i2")


def _nearest_colours(surface: Surface, points: NDArray[np.float64]) -> NDArray[np.uint8]:
    from visuohaptic.geometry.compiled_open3d import open3d

    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    tensor = open3d.core.Tensor
    scene.add_triangles(
        tensor(np.ascontiguousarray(surface.vertices, dtype=np.float32)),
        tensor(np.ascontiguousarray(surface.faces, dtype=np.uint32)),
    )
    nearest = scene.compute_closest_points(tensor(np.ascontiguousarray(points, dtype=np.float32)))
    return surface.face_colours[nearest["primitive_ids"].numpy()]
