"""What a view costs on one core from mesh to fixations, and what an imprint at a fixation costs.

Run it as ``python -m benchmarks.looking``. Beside each stands what Open3D takes to cast the same
rays, all of them ready made. All take turns in every round; figures are medians over the rounds,
averaged over the objects.
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
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor import SensorParameters, touch
from visuohaptic.sensor.imprints import make_poses, sensing_offsets

MESHES = Path(__file__).parent.parent / "meshes" / "paper"
CAMERAS = place_cameras(ViewpointParameters())
RENDERING = RenderingParameters()
ATTENTION = AttentionParameters()
SENSOR = SensorParameters()


def run(rounds: int = 7) -> dict[str, object]:
    """Time views and imprints of the twelve objects that the repository carries, each so many rounds.

    ``view_ms``: rendering and attention, their sum, the bare cast of a view's rays, and the first
    view of an object, for which its surface is prepared; ``imprint_ms``: an imprint and the bare
    cast of its rays; and the ratio of each two.
    """
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        with threadpool_limits(1):
            measured = [_measure(path, rounds) for path in sorted(MESHES.rglob("*.ply.gz"))]
    finally:
        cv2.setNumThreads(threads)
    mean = {name: float(np.mean([one[name] for one in measured])) for name in measured[0]}
    view = mean["rendering"] + mean["attention"]
    imprint, bare_imprint = mean.pop("imprint"), mean.pop("bare imprint")
    return {
        "view_ms": mean | {"mesh to fixations": view},
        "view over bare cast": view / mean["bare cast"],
        "imprint_ms": {"imprint": imprint, "bare cast": bare_imprint},
        "imprint over bare cast": imprint / bare_imprint,
    }


def _measure(path: Path, rounds: int) -> dict[str, float]:
    """Give the median processor milliseconds a view or imprint of one object."""
    surface = normalise(read_surface(path), path.name)
    caster, bare = RayCaster(surface), open3d_cast(surface)
    views = render_views(caster, CAMERAS, RENDERING)
    paths = [one.scanpath for one in attend_to(views, ATTENTION)]
    points = np.concatenate([path.points for path in paths])
    normals = np.concatenate([path.normals for path in paths])
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
    """Give the rays of the largest sensor at each point."""
    poses = make_poses(points, normals)
    offsets = 0.5 * SENSOR.largest_size * sensing_offsets(SENSOR.resolution)
    starts = (points + caster.reach * normals)[:, None, None]
    starts = starts + offsets[:, None, None] * poses.rows[:, None, None]
    starts = starts + offsets[:, None] * poses.columns[:, None, None]
    return starts.reshape(-1, 3), np.repeat(-normals, SENSOR.resolution**2, axis=0)


if __name__ == "__main__":
    print(json.dumps(run(), indent=1))
