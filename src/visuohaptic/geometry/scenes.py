"""The packages that cast rays in float32: Embree through Open3D or through embreex.

`raycasting.RayCaster` computes doubtful hits again in float64, so that both packages nearly always give the same bits;
docs/decisions.md says how often they differ.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.util import find_spec

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MissingPackageError
from visuohaptic.geometry.cast_rays import RayScene


def _open3d_scene(corners: FloatArray, faces: IntArray) -> RayScene:
    from visuohaptic.geometry.open3d_scene import Open3DScene

    return Open3DScene(corners, faces)


def _embreex_scene(corners: FloatArray, faces: IntArray) -> RayScene:
    from visuohaptic.geometry.embreex_scene import EmbreexScene

    return EmbreexScene(corners, faces)


SCENES: Mapping[str, Callable[[FloatArray, IntArray], RayScene]] = {
    "open3d": _open3d_scene,
    "embreex": _embreex_scene,
}
"""Packages that cast rays; the first installed package is used, unless the caller chooses."""


def installed_package() -> str:
    """Return the name of the first installed package of `SCENES`.

    Raises `MissingPackageError` if none is installed.
    """
    for package in SCENES:
        if find_spec(package) is not None:
            return package
    raise MissingPackageError(
        "Neither open3d nor embreex is installed; one of them is needed to cast rays: "
        "`pip install embreex` or `pip install 'visuohaptic[open3d]'`."
    )
