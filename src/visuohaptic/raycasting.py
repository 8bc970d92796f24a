"""Rays against a triangle surface, many at once, through Open3D's Embree scene.

Embree finds the face in float32; the distance to that face's plane is computed
anew in float64. What is left of float32 is the choice of the face, which can be
wrong within about 1e-7 of an edge: `RayCaster.settled_hits` looks at such rays again.
"""

from __future__ import annotations

import ctypes
import importlib.util
from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from visuohaptic.surface import Surface

MISS = -1

# Embree's float32 may take a ray this far (in the surface's unit) to the wrong side of an edge:
# eight roundings of coordinates of size 3.
LATERAL_ERROR = 2e-6
# Rays that look for candidate faces around a doubtful ray stand this far off it.
_BUNDLE_RADIUS = 3e-6
_BUNDLE = np.array(
    [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1], [0.7, 0.7], [-0.7, 0.7], [-0.7, -0.7], [0.7, -0.7]]
)
# Barycentric weights down to this much below zero still count as inside, so that two faces
# share their edge without a gap.
_EDGE_SLACK = 1e-12


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
        The surface; keep it near the origin and near unit size, for faces are
        found in float32.
    """

    def __init__(self, surface: Surface) -> None:
        open3d = load_open3d()
        self.surface = surface
        self.corners = surface.triangles
        crosses = surface.face_crosses
        self.planes = np.column_stack([crosses, np.einsum("ij,ij->i", crosses, self.corners[:, 0])])
        self._doubled_areas = np.linalg.norm(crosses, axis=1)
        self._tensor = open3d.core.Tensor
        self._miss = open3d.t.geometry.RaycastingScene.INVALID_ID
        self._scene = open3d.t.geometry.RaycastingScene(nthreads=1)
        self._scene.add_triangles(
            self._tensor(np.ascontiguousarray(surface.vertices, dtype=np.float32)),
            self._tensor(np.ascontiguousarray(surface.faces, dtype=np.uint32)),
        )

    @property
    def reach(self) -> float:
        """A length that no two points of the surface's bounding box are farther apart than."""
        vertices = self.surface.vertices
        return float(np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0)))

    def first_hits(self, origins: NDArray[np.float64], directions: NDArray[np.float64]) -> Hits:
        """Cast rays and give the first hit of each.

        Parameters
        ----------
        origins, directions : numpy.ndarray
            Shape (n, 3) each; the frame and unit of the surface's vertices.

        Returns
        -------
        Hits
            One entry a ray; independent of what else is in the batch. Faces are
            found in float32, distances are to the face's plane in float64.
        """
        rays = np.concatenate([origins, directions], axis=1, dtype=np.float32, casting="same_kind")
        answer = self._scene.cast_rays(self._tensor(rays))
        faces = answer["primitive_ids"].numpy()
        hit = faces != self._miss
        faces = np.where(hit, faces, 0).astype(np.int64)
        coarse = answer["t_hit"].numpy().astype(np.float64)
        distance = np.where(hit, self._plane_distances(faces, origins, directions, coarse), np.inf)
        barycentric = np.where(hit[:, None], answer["primitive_uvs"].numpy(), 0.0)
        return Hits(distance, np.where(hit, faces, MISS), barycentric.astype(np.float64))

    def _plane_distances(
        self,
        faces: NDArray[np.int64],
        origins: NDArray[np.float64],
        directions: NDArray[np.float64],
        fallback: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        planes = self.planes[faces]
        above = planes[:, 3] - np.einsum("ij,ij->i", planes[:, :3], origins)
        along = np.einsum("ij,ij->i", planes[:, :3], directions)
        return np.divide(above, along, out=fallback, where=along != 0)


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
