"""What attention costs on one core, beside its peers and at each resolution.

Run it as ``python benchmarks/attention.py``. Rendering is not counted. Peers are
interleaved, and medians are compared within one run.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from benchmarks.turns import in_turn, medians, ratios
from visuohaptic.attention import Attention, AttentionParameters, ChannelWeights, attend
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.preparing import normalise

MESHES = Path(__file__).parent.parent / "meshes"
RESOLUTIONS = (128, 256, 512, 1024)
FIXATIONS = 5
OURS = "eight channels, with 5 fixations"


def run(rounds: int = 15) -> dict[str, object]:
    """Time the model and its peers, each so many rounds a view, and measure what resolution is worth.

    ``speed``: processor milliseconds a 256 x 256 view, and ratios; ``resolution``: rows.
    """
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        surfaces = _surfaces()
        return {"speed": _speed(surfaces, rounds), "resolution": _resolution(surfaces)}
    finally:
        cv2.setNumThreads(threads)


def _surfaces() -> list[Surface]:
    """Take six of the twelve objects that the repository carries."""
    files = sorted((MESHES / "paper").rglob("*.ply.gz"))[::2]
    return [normalise(read_surface(path), path.name) for path in files]


def _speed(surfaces: list[Surface], rounds: int) -> dict[str, object]:
    """Give processor milliseconds a view, and each peer's ratio to ours; maps alone where nothing else is said."""
    camera = place_cameras(ViewpointParameters())[2]
    scenes = [render_views(RayCaster(surface), [camera], _at(256)) for surface in surfaces]
    saliency: Any = cv2.saliency
    peers = {
        "OpenCV FineGrained": saliency.StaticSaliencyFineGrained_create(),
        "OpenCV SpectralResidual": saliency.StaticSaliencySpectralResidual_create(),
    }
    full = AttentionParameters(fixations=FIXATIONS)
    three = AttentionParameters(
        fixations=FIXATIONS, weights=ChannelWeights.only("colour", "intensity", "orientation")
    )
    contestants = {
        OURS: partial(_each, scenes, partial(attend_to, parameters=full)),
        "three channels, with 5 fixations": partial(
            _each, scenes, partial(attend_to, parameters=three)
        ),
        "plain Itti": partial(_each, scenes, lambda views: plain_itti(views.colour[0])),
        "scikit-image, entropy alone": partial(_each, scenes, _entropy),
        **{name: partial(_each, scenes, partial(_saliency, peer)) for name, peer in peers.items()},
    }
    seconds = in_turn(contestants, rounds)
    return {
        "milliseconds": medians(seconds, 1e3 / len(scenes)),
        "ratio_to_ours": ratios(seconds, OURS),
    }


def _each(scenes: list[Views], work: Callable[[Views], object]) -> None:
    for views in scenes:
        work(views)


def _saliency(peer: Any, views: Views) -> object:
    return peer.computeSaliency(_bytes(views))


def _entropy(views: Views) -> object:
    from skimage.filters.rank import entropy
    from skimage.morphology import disk

    return entropy(_bytes(views).mean(axis=2).astype(np.uint8), disk(5))


def _resolution(surfaces: list[Surface]) -> list[dict[str, float]]:
    """Compare fixations at each resolution with those at the largest."""
    cameras = place_cameras(ViewpointParameters())[::4]
    parameters = AttentionParameters(fixations=FIXATIONS)
    points: dict[int, list[np.ndarray]] = {}
    seconds: dict[int, tuple[float, float]] = {}
    for resolution in RESOLUTIONS:
        points[resolution], rendering, attending = [], 0.0, 0.0
        for surface in surfaces:
            caster = RayCaster(surface)
            start = time.process_time()
            views = render_views(caster, cameras, _at(resolution))
            middle = time.process_time()
            results = attend_to(views, parameters)
            rendering += middle - start
            attending += time.process_time() - middle
            points[resolution] += [result.scanpath.points for result in results]
        count = len(surfaces) * len(cameras)
        seconds[resolution] = (rendering / count, attending / count)
    reference = points[RESOLUTIONS[-1]]
    rows = []
    for resolution in RESOLUTIONS:
        gaps = [
            np.linalg.norm(found[:, None] - sought[None], axis=2).min(axis=1)
            for found, sought in zip(points[resolution], reference, strict=True)
        ]
        firsts = [
            float(np.linalg.norm(found[0] - sought[0]))
            for found, sought in zip(points[resolution], reference, strict=True)
        ]
        rows.append(
            {
                "resolution": resolution,
                "median distance to the nearest reference fixation, object radii": float(
                    np.median(np.concatenate(gaps))
                ),
                "share within one focus radius": float(
                    np.mean(np.concatenate(gaps) < parameters.focus_radius)
                ),
                "median distance of the first fixation, object radii": float(np.median(firsts)),
                "rendering, s a view": seconds[resolution][0],
                "attention, s a view": seconds[resolution][1],
            }
        )
    return rows


def plain_itti(colour: np.ndarray) -> np.ndarray:
    """Give a saliency map of a picture (h, w, 3) by three channels in the plainest form, as a yardstick for time.

    It has a sixteenth of the rows and columns.
    """
    red, green, blue = cv2.split(colour)
    intensity = (red + green + blue) / 3
    opponents = [red - green, blue - 0.5 * (red + green)]
    size = tuple(side // 16 for side in intensity.shape[::-1])
    angles = [cv2.getGaborKernel((9, 9), 7 / 3, a, 7, 1, 0) for a in np.pi * np.arange(4) / 4]
    channels = [[_levels(intensity)], [_levels(plane) for plane in opponents]]
    channels.append(
        [[np.abs(cv2.filter2D(level, -1, kernel)) for level in channels[0][0]] for kernel in angles]
    )
    total = np.zeros(size[::-1], dtype=np.float32)
    for pyramids in channels:
        part = np.zeros_like(total)
        for levels in pyramids:
            for centre in (2, 3):
                for surround in (centre + 2, centre + 3):
                    coarse = cv2.resize(levels[surround], levels[centre].shape[::-1])
                    part += _itti_promoted(cv2.resize(np.abs(levels[centre] - coarse), size))
        total += _itti_promoted(part)
    return total


def _levels(plane: np.ndarray) -> list[np.ndarray]:
    levels = [plane]
    for _ in range(6):
        levels.append(cv2.pyrDown(levels[-1]))
    return levels


def _itti_promoted(plane: np.ndarray) -> np.ndarray:
    plane = plane / max(float(plane.max()), 1e-9)
    peaks = plane[(plane == cv2.dilate(plane, np.ones((3, 3)))) & (plane > 0.1)]
    return plane * (1.0 - (float(peaks.mean()) if len(peaks) > 1 else 0.0)) ** 2


def _at(resolution: int) -> RenderingParameters:
    return RenderingParameters(resolution=resolution)


def _bytes(views: Views) -> np.ndarray:
    return np.rint(views.colour[0] * 255).astype(np.uint8)


def attend_to(views: Views, parameters: AttentionParameters) -> list[Attention]:
    """Find the fixations of views."""
    return attend(
        views.colour,
        views.mask,
        views.point,
        views.normal,
        views.face,
        views.curvature,
        parameters,
    )


if __name__ == "__main__":
    print(json.dumps(run(), indent=1))
