"""Cast rays by Embree without further work: a lower bound of the time of a cast."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from visuohaptic.geometry.surface import Surface

Cast = Callable[[np.ndarray], np.ndarray]
"""Takes rays (n, 6), float32, and returns distances (n,), infinite for a miss."""


def open3d_cast(surface: Surface) -> Cast:
    """Return a function that casts rays at a surface by Open3D, on one thread."""
    import open3d

    tensor: Any = open3d.core.Tensor
    scene: Any = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(
        tensor(surface.vertices.astype(np.float32)),
        tensor(surface.faces.astype(np.uint32)),
    )
    return lambda rays: scene.cast_rays(tensor(rays))["t_hit"].numpy()


def embreex_cast(surface: Surface) -> Cast:
    """Return a function that casts rays at a surface by embreex."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    mesh = TriangleMesh(scene, surface.vertices.astype(np.float32), surface.faces.astype(np.int32))

    def cast(rays: np.ndarray, _: object = mesh) -> np.ndarray:
        origins, directions = (np.ascontiguousarray(part) for part in np.hsplit(rays, 2))
        distances = scene.run(origins, directions, query="DISTANCE")
        return np.where(distances < 1e37, distances, np.inf)

    return cast


def rays_of(origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Join origins and directions (n, 3) to rays (n, 6), float32."""
    # C order, because the packages would copy another order in every cast.
    return np.concatenate([origins, directions], axis=1).astype(np.float32, order="C")
