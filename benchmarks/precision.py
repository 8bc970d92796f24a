"""What accuracy costs: for each kernel, settings against error and seconds.

Run it as ``python -m benchmarks.precision [FILE]``; the file becomes a list of flat records. Errors
are against closed forms, brute force in float64 or exact rationals, as `visuohaptic.stability` has
them; seconds are medians of interleaved rounds on one core.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from contourlets import Contourlet, contourlet_operator, directional_deviations
from visuohaptic.attention import AttentionParameters, attend
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.touching import touch

ROOT = Path(__file__).parent.parent
RAYS = 20_000
IMAGES = 256
TOUCHES = 64

Setting = tuple[str, float, float, float, Callable[[], object]]
"""What it is, largest and root mean square error, how much is done in one call, and the call."""


def run(rounds: int = 3) -> dict[str, object]:
    """Measure every kernel.

    Parameters
    ----------
    rounds : int
        How often each setting runs; the median counts.

    Returns
    -------
    dict of str to object
        `work_precision`: rows of kernel, settings, errors, their unit, seconds and per what.
    """
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    sys.path.insert(0, str(ROOT / "tests"))
    try:
        rows = [*_rays(rounds), *_imprints(rounds), *_contourlets(rounds), *_attention(rounds)]
    finally:
        sys.path.remove(str(ROOT / "tests"))
        cv2.setNumThreads(threads)
    return {"work_precision": rows}


def _timed(
    kernel: str, unit: str, per: str, settings: list[Setting], rounds: int
) -> list[dict[str, Any]]:
    taken: dict[str, list[float]] = {setting[0]: [] for setting in settings}
    for _ in range(rounds):
        for name, _, _, amount, call in settings:
            start = time.perf_counter()
            call()
            taken[name].append((time.perf_counter() - start) / amount)
    return [
        {
            "kernel": kernel,
            "settings": name,
            "worst_error": float(worst),
            "rms_error": float(rms),
            "unit": unit,
            "seconds": float(np.median(taken[name])),
            "per": per,
        }
        for name, worst, rms, _, _ in settings
    ]


def _spread(errors: np.ndarray) -> tuple[float, float]:
    return float(np.max(np.abs(errors))), float(np.sqrt(np.mean(np.square(errors))))


def _rays(rounds: int) -> list[dict[str, Any]]:
    """Cast rays at edges and at random, in each precision; and at finer and finer balls."""
    from numerics.surfaces import ball, closed_shapes

    from visuohaptic.stability import oracles

    generator = np.random.default_rng(1)
    torus = closed_shapes()["torus"]
    corners = torus.triangles[generator.integers(0, len(torus.faces), RAYS)]
    # Beside an edge by a billionth to a hundredth of the face.
    beside = 10.0 ** generator.uniform(-9, -2, (RAYS, 1))
    targets = corners[:, 0] + generator.random((RAYS, 1)) * (corners[:, 1] - corners[:, 0])
    targets += beside * (corners[:, 2] - targets)
    origins = generator.normal(size=(RAYS, 3))
    origins *= 2 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = targets - origins
    exact, _, unsure = oracles.first_hits(torus.triangles, origins, directions)
    sure = np.isfinite(exact) & ~unsure
    caster = RayCaster(torus)
    everything = lambda distances: np.ones(len(distances), dtype=bool)  # noqa: E731
    calls = {
        "float32 as Embree gives it": lambda: _embree(caster, origins, directions),
        "doubtful rays cast again": lambda: caster.first_hits(origins, directions).distance,
        "doubtful rays and misses cast again": lambda: (
            caster.first_hits(origins, directions, lambda d: ~np.isfinite(d)).distance
        ),
        "every ray cast again": lambda: caster.first_hits(origins, directions, everything).distance,
    }
    settings: list[Setting] = []
    for name, call in calls.items():
        found = call()
        error = np.where(np.isfinite(found[sure]), found[sure] - exact[sure], 1.0)
        settings.append((f"beside edges: {name}", *_spread(error), RAYS / 1e6, call))
    balls: list[Setting] = []
    away = generator.normal(size=(RAYS, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    for level in (2, 3, 4, 5, 6):
        caster = RayCaster(ball(level))
        error = caster.first_hits(2 * away, -away).distance - 1
        call = lambda caster=caster: caster.first_hits(2 * away, -away)  # noqa: E731
        balls.append(
            (
                f"true sphere by {len(caster.surface.faces):,} faces",
                *_spread(error),
                RAYS / 1e6,
                call,
            )
        )
    unit = "distance, object radii"
    return [
        *_timed("ray cast", unit, "million rays", settings, rounds),
        *_timed("ray cast", unit, "million rays", balls, rounds),
    ]


def _embree(caster: RayCaster, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    rays = np.concatenate([origins, directions], axis=1).astype(np.float32)
    answer: np.ndarray = caster._scene.cast_rays(caster._tensor(rays))["t_hit"].numpy()
    return answer.astype(np.float64)


def _imprints(rounds: int) -> list[dict[str, Any]]:
    """Touch balls: how fine the mesh, and how many sensing points."""
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
        call = lambda c=caster, p=points, n=normals, s=parameters: touch(c, p, n, s, Scene())  # noqa: E731
        felt = call()
        whole = felt.size == parameters.largest_size
        # Mean relief of the true cap under the square, by a fine midpoint rule.
        steps = ((np.arange(1024) + 0.5) / 1024 - 0.5) * parameters.largest_size
        cap = 1 - np.sqrt(1 - steps[:, None] ** 2 - steps[None, :] ** 2)
        error = felt.gaps[whole].mean(axis=(1, 2)) - cap.mean()
        name = f"{resolution} × {resolution} points, {len(surface.faces):,} faces"
        settings.append((name, *_spread(error), len(points) / 1e3, call))
    return _timed("imprint", "mean relief, object radii", "thousand touches", settings, rounds)


def _contourlets(rounds: int) -> list[dict[str, Any]]:
    """Deviations of 16 bands: which type, and matrix or ladder."""
    from numerics.test_images import exact_products

    generator = np.random.default_rng(2)
    images = generator.random((IMAGES, 16, 16))
    exact = []
    for image in images[:8]:
        products, unit, sizes = exact_products(image)
        values = np.array([float(_quotient(value, unit)) for value in products])
        bands = np.split(values, np.cumsum(sizes)[:-1])[1:]
        exact.append([band.std(ddof=1) for band in bands])
    wanted = np.array(exact)
    calls = {
        "float64, ladder": lambda: directional_deviations(images),
        "float32, ladder": lambda: _ladder(images.astype(np.float32)),
        "float64, one matrix": lambda: _matrix(images, np.float64),
        "float32, one matrix": lambda: _matrix(images, np.float32),
    }
    settings: list[Setting] = [
        (f"16 × 16, {name}", *_spread(call()[:8] - wanted), IMAGES / 1e3, call)
        for name, call in calls.items()
    ]
    return _timed(
        "contourlet", "deviation of a band, full scale", "thousand imprints", settings, rounds
    )


def _quotient(value: int, unit: int) -> float:
    from fractions import Fraction

    return float(Fraction(value, unit))


def _ladder(images: np.ndarray) -> np.ndarray:
    bands = Contourlet(levels=(4,)).forward(images).levels[0]
    return np.stack([band.std(axis=(1, 2), ddof=1) for band in bands], axis=1)


def _matrix(images: np.ndarray, dtype: type) -> np.ndarray:
    operator = contourlet_operator(Contourlet(levels=(4,)), (16, 16), dtype)
    bands = operator.forward(images.astype(dtype)).levels[0]
    return np.stack([band.std(axis=(1, 2), ddof=1) for band in bands], axis=1)


def _attention(rounds: int) -> list[dict[str, Any]]:
    """Fixations at each resolution of the view against those at the largest."""
    files = sorted((ROOT / "meshes/paper").rglob("*.ply.gz"))[::4]
    surfaces: list[Surface] = [normalise(read_surface(path), path.name) for path in files]
    cameras = place_cameras(ViewpointParameters())[::4]
    casters = [RayCaster(surface) for surface in surfaces]
    parameters = AttentionParameters()
    points: dict[int, list[np.ndarray]] = {}
    views: dict[int, list[Any]] = {}
    for resolution in (64, 128, 256, 512, 1024):
        at = RenderingParameters(resolution=resolution)
        views[resolution] = [render_views(caster, cameras, at) for caster in casters]
        found = [_attend(seen, parameters) for seen in views[resolution]]
        points[resolution] = [one.scanpath.points for each in found for one in each]
    settings: list[Setting] = []
    for resolution in (64, 128, 256, 512):
        apart = [
            np.linalg.norm(one[:, None] - other[None], axis=2).min(axis=1)
            for one, other in zip(points[resolution], points[1024], strict=True)
        ]
        joined = np.concatenate(apart)
        call = lambda r=resolution: [_attend(seen, parameters) for seen in views[r]]  # noqa: E731
        amount = len(surfaces) * len(cameras)
        name = f"{resolution} × {resolution} pixels"
        settings.append((name, float(joined.max()), float(np.median(joined)), amount, call))
    return _timed(
        "attention",
        "distance to the nearest fixation at 1024², object radii",
        "view",
        settings,
        rounds,
    )


def _attend(views: Any, parameters: AttentionParameters) -> list[Any]:
    return attend(
        colour=views.colour,
        mask=views.mask,
        point=views.point,
        normal=views.normal,
        face=views.face,
        curvature=views.curvature,
        parameters=parameters,
    )


if __name__ == "__main__":
    found = run()["work_precision"]
    for row in found:  # type: ignore[attr-defined]
        print(
            f"{row['kernel']:11} {row['settings']:58} {row['worst_error']:9.2e} {row['rms_error']:9.2e} "
            f"{row['seconds']:9.2e} s a {row['per']}"
        )
    if len(sys.argv) > 1:
        target = Path(sys.argv[1])
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
