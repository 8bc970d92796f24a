"""Measure error and run time of each kernel under several settings: `python -m benchmarks.precision`.

Errors are measured against closed forms, brute force in float64, or exact rationals, as in `visuohaptic.stability`.
Seconds are medians of interleaved rounds on one core.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import cv2
import numpy as np

from benchmarks.attention import CAMERAS, attend_to, every_paper_object, nearest
from benchmarks.casts import open3d_cast, rays_of
from benchmarks.turns import in_turn, medians
from contourlets import Contourlet, ContourletOperator, contourlet_operator, directional_deviations
from visuohaptic.attention import Attention, AttentionParameters
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.sensing import touch

RAYS = 20_000
IMAGES = 256
TOUCHES = 64

Setting = tuple[str, float, float, float, Callable[[], object]]
"""Name, largest and root mean square error, amount of work per call, and the call."""


def run(rounds: int = 3) -> dict[str, list[dict[str, Any]]]:
    """Measure every kernel and setting; seconds are medians over the rounds.

    Returns ``work_precision``: rows with kernel, settings, errors and their unit, and seconds per unit of work.
    """
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        rows = [*_rays(rounds), *_imprints(rounds), *_contourlets(rounds), *_attention(rounds)]
    finally:
        cv2.setNumThreads(threads)
    return {"work_precision": rows}


def _timed(
    kernel: str, unit: str, per: str, settings: list[Setting], rounds: int
) -> list[dict[str, Any]]:
    seconds = medians(in_turn({name: call for name, _, _, _, call in settings}, rounds))
    return [
        {
            "kernel": kernel,
            "settings": name,
            "worst_error": float(worst),
            "rms_error": float(rms),
            "unit": unit,
            "seconds": seconds[name] / amount,
            "per": per,
        }
        for name, worst, rms, amount, _ in settings
    ]


def _spread(errors: np.ndarray) -> tuple[float, float]:
    return float(np.max(np.abs(errors))), float(np.sqrt(np.mean(np.square(errors))))


def _rays(rounds: int) -> list[dict[str, Any]]:
    """Cast rays near edges in each precision, and rays at spheres of 5 levels of subdivision."""
    from numerics.surfaces import ball, closed_shapes

    from visuohaptic.stability import oracles

    generator = np.random.default_rng(1)
    torus = closed_shapes()["torus"]
    corners = torus.triangles[generator.integers(0, len(torus.faces), RAYS)]
    # Distance from an edge: 1e-9 to 1e-2 of the face.
    beside = 10.0 ** generator.uniform(-9, -2, (RAYS, 1))
    targets = corners[:, 0] + generator.random((RAYS, 1)) * (corners[:, 1] - corners[:, 0])
    targets += beside * (corners[:, 2] - targets)
    origins = generator.normal(size=(RAYS, 3))
    origins *= 2 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = targets - origins
    exact, unsure = oracles.first_hits(torus.triangles, origins, directions)
    sure = np.isfinite(exact) & ~unsure
    caster = RayCaster(torus)
    bare, joined = open3d_cast(torus), rays_of(origins, directions)
    calls: dict[str, Callable[[], np.ndarray]] = {
        "float32 as Embree gives it": lambda: bare(joined).astype(np.float64),
        "doubtful rays cast again": lambda: caster.first_hits(origins, directions).distance,
        "doubtful rays and misses cast again": lambda: (
            caster.first_hits(origins, directions, lambda d: ~np.isfinite(d)).distance
        ),
        "every ray cast again": lambda: (
            caster.first_hits(origins, directions, lambda d: np.ones(len(d), dtype=bool)).distance
        ),
    }
    settings: list[Setting] = []
    for name, call in calls.items():
        distance = call()[sure]
        error = np.where(np.isfinite(distance), distance - exact[sure], 1.0)
        settings.append((f"beside edges: {name}", *_spread(error), RAYS / 1e6, call))
    balls: list[Setting] = []
    away = generator.normal(size=(RAYS, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    for level in (2, 3, 4, 5, 6):
        surface = ball(level)
        cast = partial(RayCaster(surface).first_hits, 2 * away, -away)
        name = f"true sphere by {len(surface.faces):,} faces"
        balls.append((name, *_spread(cast().distance - 1), RAYS / 1e6, cast))
    unit = "distance, object radii"
    return [
        *_timed("ray cast", unit, "million rays", settings, rounds),
        *_timed("ray cast", unit, "million rays", balls, rounds),
    ]


def _imprints(rounds: int) -> list[dict[str, Any]]:
    """Touch spheres with several numbers of faces and of sensing points."""
    from numerics.surfaces import ball

    settings: list[Setting] = []
    for level, resolution in ((3, 32), (4, 32), (5, 32), (6, 32), (6, 8), (6, 16), (6, 64)):
        surface = ball(level)
        caster = RayCaster(surface)
        points = surface.vertices[:: max(len(surface.vertices) // TOUCHES, 1)][:TOUCHES]
        normals = points / np.linalg.norm(points, axis=1, keepdims=True)
        parameters = SensorParameters(
            resolution=resolution, normal="given", normalisation="absolute", largest_size=0.2
        )
        call = partial(touch, caster, points, normals, parameters, Scene())
        felt = call()
        whole = felt.size == parameters.largest_size
        # Mean relief of the exact cap under the square, by the midpoint rule.
        steps = ((np.arange(1024) + 0.5) / 1024 - 0.5) * parameters.largest_size
        cap = 1 - np.sqrt(1 - steps[:, None] ** 2 - steps[None, :] ** 2)
        error = felt.gaps[whole].mean(axis=(1, 2)) - cap.mean()
        name = f"{resolution} × {resolution} points, {len(surface.faces):,} faces"
        settings.append((name, *_spread(error), len(points) / 1e3, call))
    return _timed("imprint", "mean relief, object radii", "thousand touches", settings, rounds)


def _contourlets(rounds: int) -> list[dict[str, Any]]:
    """Compute deviations of 16 bands in both precisions, by the ladder or a matrix."""
    from numerics.hard_cases.images import exact_bands, exact_deviation

    images = np.random.default_rng(2).random((IMAGES, 16, 16))
    wanted = np.array(
        [[exact_deviation(band) for band in exact_bands(image)[1:]] for image in images[:8]]
    )
    ladder = Contourlet(levels=(4,))
    calls: dict[str, Callable[[], np.ndarray]] = {
        "float64, ladder": lambda: directional_deviations(images),
        "float32, ladder": partial(_deviations, ladder, images, np.float32),
    }
    for name, dtype in (("float64", np.float64), ("float32", np.float32)):
        operator = contourlet_operator(ladder, (16, 16), dtype)
        calls[f"{name}, one matrix"] = partial(_deviations, operator, images, dtype)
    settings: list[Setting] = [
        (f"16 × 16, {name}", *_spread(call()[:8] - wanted), IMAGES / 1e3, call)
        for name, call in calls.items()
    ]
    return _timed(
        "contourlet", "deviation of a band, full scale", "thousand imprints", settings, rounds
    )


def _deviations(
    transform: Contourlet | ContourletOperator, images: np.ndarray, dtype: type
) -> np.ndarray:
    bands = transform.forward(images.astype(dtype)).levels[0]
    return np.stack([band.std(axis=(1, 2), ddof=1) for band in bands], axis=1)


def _attend_to_all(views: list[Views]) -> list[Attention]:
    return [
        attention
        for of_object in views
        for attention in attend_to(of_object, AttentionParameters())
    ]


def _attention(rounds: int) -> list[dict[str, Any]]:
    """Compare fixations at each resolution with fixations at the largest resolution."""
    casters = [RayCaster(surface) for surface in every_paper_object(4)]
    views: dict[int, list[Views]] = {}
    points: dict[int, list[np.ndarray]] = {}
    for resolution in (64, 128, 256, 512, 1024):
        at = RenderingParameters(resolution=resolution)
        views[resolution] = [render_views(caster, CAMERAS, at) for caster in casters]
        attended = _attend_to_all(views[resolution])
        points[resolution] = [attention.scanpath.points for attention in attended]
    references = points.pop(1024)
    settings: list[Setting] = []
    for resolution, fixations_of_views in points.items():
        pairs = zip(fixations_of_views, references, strict=True)
        gaps = np.concatenate([nearest(fixations, reference) for fixations, reference in pairs])
        call = partial(_attend_to_all, views[resolution])
        name = f"{resolution} × {resolution} pixels"
        settings.append((name, gaps.max(), np.median(gaps), len(references), call))
    return _timed(
        "attention",
        "distance to the nearest fixation at 1024², object radii",
        "view",
        settings,
        rounds,
    )


if __name__ == "__main__":
    for row in run()["work_precision"]:
        print(
            f"{row['kernel']:11} {row['settings']:58} {row['worst_error']:9.2e} {row['rms_error']:9.2e} "
            f"{row['seconds']:9.2e} s per {row['per']}"
        )
