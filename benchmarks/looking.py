"""Time a view from mesh to fixations, and an imprint at a fixation, on one core: `python -m benchmarks.looking`.

Each is compared with a cast of the same prepared rays by Open3D. All take turns in every round. Figures are medians
over the rounds, averaged over the objects.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.attention import attend_to
from benchmarks.casts import open3d_cast, rays_of
from benchmarks.turns import in_turn, medians
from visuohaptic.attention import AttentionParameters
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.layouts import sensing_offsets
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor import SensorParameters, touch
from visuohaptic.sensor.imprints import make_poses

MESHES = Path(__file__).parent.parent / "meshes" / "paper"
CAMERAS = place_cameras(ViewpointParameters())
RENDERING = RenderingParameters()
ATTENTION = AttentionParameters()
SENSOR = SensorParameters()


def run(rounds: int = 7) -> dict[str, object]:
    """Time views and imprints of the twelve objects of the repository.

    ``view_ms`` has rendering, attention, their sum, the bare cast of a view's rays, and the first view of an object,
    which includes the preparation of its surface. ``imprint_ms`` has an imprint and the bare cast of its rays. The
    ratios to the bare casts follow.
    """
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        with threadpool_limits(1):
            measured = [_measure(path, rounds) for path in sorted(MESHES.rglob("*.ply.gz"))]
    finally:
        cv2.setNumThreads(threads)
    mean = {
        name: float(np.mean([of_object[name] for of_object in measured])) for name in measured[0]
    }
    view = mean["rendering"] + mean["attention"]
    imprint, bare_imprint = mean.pop("imprint"), mean.pop("bare imprint")
    return {
        "view_ms": mean | {"mesh to fixations": view},
        "view over bare cast": view / mean["bare cast"],
        "imprint_ms": {"imprint": imprint, "bare cast": bare_imprint},
        "imprint over bare cast": imprint / bare_imprint,
    }


def _measure(path: Path, rounds: int) -> dict[str, float]:
    """Return median processor milliseconds per view or imprint of an object."""
    surface = normalise(read_surface(path), path.name).surface
    caster, bare = RayCaster(surface), open3d_cast(surface)
    views = render_views(caster, CAMERAS, RENDERING)
    paths = [attention.scanpath for attention in attend_to(views, ATTENTION)]
    points = np.concatenate([scanpath.points for scanpath in paths])
    normals = np.concatenate([scanpath.normals for scanpath in paths])
    of_views = [rays_of(*camera.rays(RENDERING.resolution)) for camera in CAMERAS]
    of_imprints = rays_of(*sensing_rays(caster, points, normals))
    contestants: dict[str, tuple[Callable[[], object], int]] = {
        "first view": (lambda: render_views(RayCaster(surface), CAMERAS[:1], RENDERING), 1),
        "rendering": (lambda: render_views(caster, CAMERAS, RENDERING), len(CAMERAS)),
        "attention": (lambda: attend_to(views, ATTENTION), len(CAMERAS)),
        "bare cast": (lambda: [bare(rays) for rays in of_views], len(CAMERAS)),
        "imprint": (lambda: touch(caster, points, normals, SENSOR, Scene()), len(points)),
        "bare imprint": (lambda: bare(of_imprints), len(points)),
    }
    seconds = in_turn({name: call for name, (call, _) in contestants.items()}, rounds)
    return {name: 1e3 * taken / contestants[name][1] for name, taken in medians(seconds).items()}


def sensing_rays(
    caster: RayCaster, points: np.ndarray, normals: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return origins and directions (n, 3) of the rays of the largest sensor at each point."""
    poses = make_poses(points, normals)
    offsets = 0.5 * SENSOR.largest_size * sensing_offsets(SENSOR.resolution)
    starts = (points + caster.reach * normals)[:, None, None]
    starts = starts + offsets[:, None, None] * poses.rows[:, None, None]
    starts = starts + offsets[:, None] * poses.columns[:, None, None]
    return starts.reshape(-1, 3), np.repeat(-normals, SENSOR.resolution**2, axis=0)


if __name__ == "__main__":
    print(json.dumps(run(), indent=1))
