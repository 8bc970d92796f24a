"""Measure fixations and run time of attention by resolution, on one core: `python -m benchmarks attention`."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from visuohaptic.attention import Attention, AttentionParameters, attend
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.preparing import normalise

PAPER = Path(__file__).parent.parent / "meshes/paper"
RESOLUTIONS = (128, 256, 512, 1024)
CAMERAS = place_cameras(ViewpointParameters())[::4]
PARAMETERS = AttentionParameters(fixations=5)


def run() -> dict[str, object]:
    """Compare fixations at each resolution with fixations at the largest resolution, on six objects of the repository."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        return {"resolution": _rows(every_paper_object(2))}
    finally:
        cv2.setNumThreads(threads)


def every_paper_object(step: int) -> list[Surface]:
    """Read and normalise every `step`-th of the twelve objects of the repository."""
    files = sorted(PAPER.rglob("*.ply.gz"))[::step]
    return [normalise(read_surface(path), path.name).surface for path in files]


def _rows(surfaces: Sequence[Surface]) -> list[dict[str, float]]:
    points: dict[int, list[np.ndarray]] = {}
    seconds: dict[int, np.ndarray] = {}
    for resolution in RESOLUTIONS:
        points[resolution], seconds[resolution] = [], np.zeros(2)
        for surface in surfaces:
            caster, start = RayCaster(surface), time.process_time()
            views = render_views(caster, CAMERAS, RenderingParameters(resolution=resolution))
            middle = time.process_time()
            results = attend_to(views, PARAMETERS)
            seconds[resolution] += (middle - start, time.process_time() - middle)
            points[resolution] += [result.scanpath.points for result in results]
    rows = []
    for resolution in RESOLUTIONS:
        pairs = list(zip(points[resolution], points[RESOLUTIONS[-1]], strict=True))
        gaps = np.concatenate([nearest(fixations, reference) for fixations, reference in pairs])
        firsts = [
            float(np.linalg.norm(fixations[0] - reference[0])) for fixations, reference in pairs
        ]
        rendering, attending = seconds[resolution] / len(pairs)
        rows.append(
            {
                "resolution": resolution,
                "median distance to the nearest reference fixation, object radii": float(
                    np.median(gaps)
                ),
                "share within one focus radius": float(np.mean(gaps < PARAMETERS.focus_radius)),
                "median distance of the first fixation, object radii": float(np.median(firsts)),
                "rendering, s a view": float(rendering),
                "attention, s a view": float(attending),
            }
        )
    return rows


def nearest(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Compute the distance (n,) of each point (n, 3) to the nearest of other points (m, 3)."""
    return np.linalg.norm(points[:, None] - others[None], axis=2).min(axis=1)


def attend_to(views: Views, parameters: AttentionParameters) -> list[Attention]:
    """Compute the fixations of views."""
    return attend(**views.attend_arguments(), parameters=parameters)
