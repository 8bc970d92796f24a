"""Rays against a triangle surface, many at once, through Open3D's Embree scene."""

from __future__ import annotations

import ctypes
import importlib.util
from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from visuohaptic.surface import Surface

MISS = -1


@dataclass(frozen=True)
class Hits:
    """Where each of n rays first meets the surface.

    Attributes
    ----------
    distance : numpy.ndarray
        Shape (n,), float64: along the ray in lengths of its direction; infinite for a miss.
    face : numpy.ndarray
        Shape (n,), int64: the face that was hit, or `MISS`.
    barycentric : numpy.ndarray
        Shape (n, 2), float64: weights of the face's second and third corner; zero for a miss.
    """

    distance: NDArray[np.float64]
    face: NDArray[np.int64]
    barycentric: NDArray[np.float64]

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Whether each ray met the surface, shape (n,)."""
        return self.face != MISS


class RayCaster:
    """A surface prepared for rays.

    Parameters
    ----------
    surface : Surface
        The surface; keep it near the origin and near unit size, for the caster
        computes in float32.
    """

    def __init__(self, surface: Surface) -> None:
        open3d = load_open3d()
        self.surface = surface
        self._tensor = open3d.core.Tensor
        self._miss = open3d.t.geometry.RaycastingScene.INVALID_ID
        self._scene = open3d.t.geometry.RaycastingScene(nthreads=1)
        self._scene.add_triangles(
            self._tensor(np.ascontiguousarray(surface.vertices, dtype=np.float32)),
            self._tensor(np.ascontiguousarray(surface.faces, dtype=np.uint32)),
        )

    def first_hits(self, origins: NDArray[np.float64], directions: NDArray[np.float64]) -> Hits:
        """Cast rays and give the first hit of each.

        Parameters
        ----------
        origins, directions : numpy.ndarray
            Shape (n, 3) each; the frame and unit of the surface's vertices.

        Returns
        -------
        Hits
            One entry a ray; independent of what else is in the batch.
        """
        rays = np.concatenate([origins, directions], axis=1).astype(np.float32)
        answer = self._scene.cast_rays(self._tensor(rays))
        faces = answer["primitive_ids"].numpy()
        hit = faces != self._miss
        return Hits(
            answer["t_hit"].numpy().astype(np.float64),
            np.where(hit, faces, 0).astype(np.int64) + np.where(hit, 0, MISS),
            np.where(hit[:, None], answer["primitive_uvs"].numpy(), 0.0).astype(np.float64),
        )


def load_open3d() -> ModuleType:
    """Import Open3D, with the USB library that its wheel needs and a bare machine lacks.

    Returns
    -------
    module
        ``open3d``.
    """
    if importlib.util.find_spec("libusb_package") is not None:
        import libusb_package

        ctypes.CDLL(str(libusb_package.get_library_path()), mode=ctypes.RTLD_GLOBAL)
    import open3d

    return open3d
