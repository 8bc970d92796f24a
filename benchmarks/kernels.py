"""Time the four inner loops and functions of other packages for the same work: `python -m benchmarks kernels`.

The peers take turns, on one thread, on the views, touches and imprints of a default run. Each ratio is the median of
the ratios within a round, averaged over the objects.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any
from unittest import mock

import cv2
import numpy as np
import pywt
from threadpoolctl import threadpool_limits

from benchmarks.attention import attend_to
from benchmarks.casts import Cast, open3d_cast, rays_of
from benchmarks.looking import sensing_rays
from benchmarks.turns import Seconds, in_turn, medians, ratios
from contourlets import directional_deviations
from visuohaptic.attention import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.cast_rays import FirstFaces, Rays
from visuohaptic.geometry.open3d_scene import Open3DScene
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.scenes import SCENES
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor import SensorParameters, touch

MESHES = Path(__file__).parent.parent / "meshes" / "paper"
ROUNDS = 7
CAMERAS = place_cameras(ViewpointParameters())
RENDERING = RenderingParameters()
ATTENTION = AttentionParameters()
EVERY_CHANNEL = AttentionParameters.model_validate({"weights": "equal"})
SENSOR = SensorParameters()

Call = Callable[[], object]


def run() -> dict[str, object]:
    """Measure and print the ratio of the time of each kernel to the time of its peer.

    - ``view``: a bare cast by Open3D of the rays of the pixels
    - ``imprint``: a bare cast by Open3D of the rays of the sensing points
    - ``contourlet``: the wavelet transform db2 of three levels by PyWavelets
    - ``channels``: OpenCV's fine-grained saliency of the same views

    ``every ray`` is the ratio of bare casts of all rays that the kernel casts: a lower bound of the kernel's ratio.
    """
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        with threadpool_limits(1):
            measured = [_measure(path) for path in sorted(MESHES.rglob("*.ply.gz"))]
    finally:
        cv2.setNumThreads(threads)
    means: dict[str, dict[str, float]] = {
        kernel: {
            name: float(np.mean([of_object[kernel][name] for of_object in measured]))
            for name in figures
        }
        for kernel, figures in measured[0].items()
    }
    print(f"{'kernel':<12}{'ms':>9}{'peer, ms':>10}{'ratio':>8}{'every ray':>11}")
    for kernel, figures in means.items():
        every = f"{figures['every_ray']:11.2f}" if "every_ray" in figures else f"{'–':>11}"
        times = f"{figures['kernel_ms']:9.3f}{figures['peer_ms']:10.3f}{figures['ratio']:8.2f}"
        print(f"{kernel:<12}{times}{every}")
    return {"rounds": ROUNDS, "objects": len(measured), "kernels": means}


def _measure(path: Path) -> dict[str, dict[str, float]]:
    surface = normalise(read_surface(path), path.name).surface
    caster = RayCaster(surface)
    views = render_views(caster, CAMERAS, RENDERING)
    paths = [attention.scanpath for attention in attend_to(views, ATTENTION)]
    points = np.concatenate([scanpath.points for scanpath in paths])
    normals = np.concatenate([scanpath.normals for scanpath in paths])
    faces = np.concatenate([scanpath.faces for scanpath in paths])

    def render(with_caster: RayCaster) -> object:
        return render_views(with_caster, CAMERAS, RENDERING)

    def press(with_caster: RayCaster) -> object:
        return touch(with_caster, points, normals, SENSOR, Scene(), faces=faces)

    images = touch(caster, points, normals, SENSOR, Scene(), faces=faces).images.astype(np.float64)
    pixels = [
        rays_of(
            *camera.rays(
                RENDERING.resolution, camera.window(surface.vertices, RENDERING.resolution)
            )
        )
        for camera in CAMERAS
    ]
    taxels = [rays_of(*sensing_rays(caster, points, normals))]
    pictures = [np.rint(255.0 * view[..., ::-1]).astype(np.uint8) for view in views.colour]
    opencv: Any = cv2
    fine_grained = opencv.saliency.StaticSaliencyFineGrained_create()
    cast = partial(_cast_all, open3d_cast(surface))
    peers: dict[str, Call] = {
        "view": partial(render, caster),
        "view peer": partial(cast, pixels),
        "view every_ray": partial(cast, _casts_of(surface, render)),
        "imprint": partial(press, caster),
        "imprint peer": partial(cast, taxels),
        "imprint every_ray": partial(cast, _casts_of(surface, press)),
        "contourlet": partial(directional_deviations, images),
        "contourlet peer": partial(pywt.wavedec2, images, "db2", "periodization", 3, (1, 2)),
        "channels": partial(attend_to, views, EVERY_CHANNEL),
        "channels peer": lambda: [fine_grained.computeSaliency(picture) for picture in pictures],
    }
    seconds = in_turn(peers, ROUNDS)
    return {name: _compare(name, seconds, count) for name, count in _counts(views, paths).items()}


def _compare(kernel: str, seconds: Seconds, count: int) -> dict[str, float]:
    """Compare a kernel with its peer in the same rounds; `count` is the number of views or imprints per call."""
    peer, every_ray = f"{kernel} peer", f"{kernel} every_ray"
    taken, shares = medians(seconds, 1e3 / count), ratios(seconds, peer)
    figures = {"kernel_ms": taken[kernel], "peer_ms": taken[peer], "ratio": shares[kernel]}
    return figures | ({"every_ray": shares[every_ray]} if every_ray in shares else {})


def _counts(views: Views, paths: Sequence[Scanpath]) -> dict[str, int]:
    """Return the number of views or imprints that a call of each kernel computes."""
    imprints = sum(scanpath.distinct for scanpath in paths)
    return {
        "view": len(views),
        "imprint": imprints,
        "contourlet": imprints,
        "channels": len(views),
    }


def _casts_of(surface: Surface, work: Callable[[RayCaster], object]) -> list[Rays]:
    """Return the rays of every cast for first hits that `work` makes."""
    casts: list[Rays] = []

    class Recorded(Open3DScene):
        def first_faces(self, rays: Rays) -> FirstFaces:
            casts.append(rays)
            return super().first_faces(rays)

    with mock.patch.dict(SCENES, {"open3d": Recorded}):
        caster = RayCaster(surface, "open3d")
    work(caster)
    return casts


def _cast_all(cast: Cast, casts: Iterable[Rays]) -> None:
    for rays in casts:
        cast(rays)


if __name__ == "__main__":
    print(json.dumps(run(), indent=1))
