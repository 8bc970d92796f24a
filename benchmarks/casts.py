"""Embree without anything around it: what a cast of rays takes at least."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from visuohaptic.geometry.surface import Surface

Cast = Callable[[np.ndarray], np.ndarray]
"""Takes rays, shape (n, 6), float32, and gives distances, shape (n,), infinite for a miss."""


def open3d_cast(surface: Surface) -> Cast:
    """Prepare a surface in Open3D, on one thread."""
    import open3d

    tensor: Any = open3d.core.Tensor
    scene: Any = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(
        tensor(surface.vertices.astype(np.float32)),
        tensor(surface.faces.astype(np.uint32)),
    )
    return lambda rays: scene.cast_rays(tensor(rays))["t_hit"].numpy()


def embreex_cast(surface: Surface) -> Cast:
    """Prepare a surface in embreex."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    mesh = TriangleMesh(scene, surface.vertices.astype(np.float32), surface.faces.astype(np.int32))

    def cast(rays: np.ndarray, _: object = mesh) -> np.ndarray:
        origins, directions = (np.ascontiguousarray(part) for part in np.hsplit(rays, 2))
        found = scene.run(origins, directions, query="DISTANCE")
        return np.where(found < 1e37, found, np.inf)

    return cast


def rays_of(origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Join origins and directions, shape (n, 3) each, as both packages take them."""
    # In rows: a package would copy another order in every cast.
    return np.concatenate([origins, directions], axis=1).astype(np.float32, order="C")
