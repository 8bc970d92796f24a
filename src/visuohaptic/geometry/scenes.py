"""What casts rays in float32: Embree through Open3D or embreex; `raycasting.RayCaster` settles what that leaves open.

What float32 may take wrongly is found again in float64, so nearly always the same bits come out of both;
docs/decisions.md says how often not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.util import find_spec

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import MissingPackageError
from visuohaptic.geometry.cast_rays import Scene


def _open3d_scene(corners: FloatArray, faces: IntArray) -> Scene:
    from visuohaptic.geometry.open3d_scene import Open3DScene

    return Open3DScene(corners, faces)


def _embreex_scene(corners: FloatArray, faces: IntArray) -> Scene:
    from visuohaptic.geometry.embreex_scene import EmbreexScene

    return EmbreexScene(corners, faces)


SCENES: Mapping[str, Callable[[FloatArray, IntArray], Scene]] = {
    "open3d": _open3d_scene,
    "embreex": _embreex_scene,
}
"""Packages that cast rays; the first that is installed does, unless another one is asked for."""


def installed_package() -> str:
    """Name the package that casts rays; raises `MissingPackageError` if there is none."""
    for package in SCENES:
        if find_spec(package) is not None:
            return package
    raise MissingPackageError(
        "Neither open3d nor embreex is installed, and one of them must cast the rays; "
        "`pip install embreex` or `pip install 'visuohaptic[open3d]'` brings one."
    )
