"""Every check, and how often it draws."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numerics.hard_cases import (
    attention,
    determinism,
    images,
    invariance,
    learning,
    meshes,
    precision,
    rays,
)
from numerics.tolerances import TOLERANCES

from visuohaptic.seeds import spawn_generator
from visuohaptic.stability.findings import Finding, Result, measure, merge_results

_SENSED = tuple(
    f"invariance/{name}"
    for name in (
        "saliency map",
        "fixated points",
        "tied peaks: fixations are those of a map within its error",
        "images",
        "features",
    )
)
Measure = Callable[[np.random.Generator], Iterable[Finding]]


@dataclass(frozen=True)
class Check:
    """One way to draw hard cases and measure their errors."""

    name: str
    measure: Measure
    tolerances: tuple[str, ...]
    draws: int
    full_draws: int


def run_check(check: Check, seed: int, draws: int) -> dict[str, Result]:
    """Draw a check's cases and measure them."""
    allowed = {name: TOLERANCES[name] for name in check.tolerances}
    return merge_results(
        replace(result, hardest=f"{result.hardest} (draw {number})")
        for number in range(draws)
        for result in measure(partial(_draw, check, seed, number), allowed)
    )


def _draw(check: Check, seed: int, number: int) -> Iterable[Finding]:
    return check.measure(spawn_generator(seed, "stability", check.name, number))


CHECKS = (
    Check("random_triangles", rays.random_triangles, ("rays/face chosen against brute force in float64", "rays/hits lie on their face's plane"), 20, 300),
    Check("vertices_and_edges", rays.vertices_and_edges, ("rays/against exact rationals, aimed at vertices and edges", "rays/leaks out of closed surfaces"), 3, 100),
    Check("leaks", rays.leaks, ("rays/leaks out of closed surfaces",), 6, 200),
    Check("grazing", rays.grazing, ("rays/grazing",), 20, 300),
    Check("within_a_plane", rays.within_a_plane, ("rays/within a face's plane",), 4, 30),
    Check("slivers", rays.slivers, ("rays/through slivers of 1e-12 area",), 4, 40),
    Check("coplanar", rays.coplanar, ("rays/coplanar faces on top of each other",), 1, 20),
    Check("off_centre", rays.off_centre, ("rays/meshes far off centre",), 10, 300),
    Check("bands", images.bands, ("images/contourlet bands against exact rationals", "images/deviations against exact rationals"), 1, 1),
    Check("reconstruction", images.reconstruction, ("images/contourlet reconstruction",), 1, 1),
    Check("flat_images", images.flat_images, ("images/deviations of flat images",), 10, 300),
    Check("images_in_other_units", images.images_in_other_units, ("images/scale by a power of two", "images/scale by 1e±150"), 10, 300),
    Check("sequence_moments", images.sequence_moments, ("images/moments of sequences against exact rationals", "images/skewness against exact rationals", "images/skewness of well spread sequences"), 40, 1000),
    Check("wavelets", images.wavelets, ("images/wavelet levels against exact rationals",), 10, 300),
    Check("imprint_shapes", images.imprint_shapes, ("images/shape of imprints against exact rationals",), 6, 300),
    Check("stretched_imprints", images.stretched_imprints, ("images/stretched imprints",), 6, 100),
    Check("hard_views", attention.hard_views, ("attention/maps are finite, within 0 and 1, zero beside the object", "attention/fixations: distinct, on the object, a focus apart"), 20, 600),
    Check("noisy_views", attention.noisy_views, ("attention/maps are finite, within 0 and 1, zero beside the object", "attention/fixations: distinct, on the object, a focus apart"), 10, 300),
    Check("views_from_within", attention.views_from_within, ("attention/maps are finite, within 0 and 1, zero beside the object", "attention/fixations: distinct, on the object, a focus apart"), 3, 50),
    Check("brightness", attention.brightness, ("attention/brightness by a power of two",), 6, 300),
    Check("inhibition", attention.inhibition, ("attention/way of the eye against its definition in float64",), 10, 300),
    Check("pyramids", attention.pyramids, ("attention/pyramid against scipy.ndimage",), 10, 300),
    Check("sphere_curvature", attention.sphere_curvature, ("attention/a uniform sphere's curvature",), 1, 6),
    Check("classifiers", learning.classifiers, ("learning/every classifier ends in labels",), 7, 100),
    Check("feature_units", learning.units, ("learning/each standardised feature rescaled by 1e±8", "learning/each standardised feature rescaled by powers of two", "learning/all features alike rescaled by 1e±8", "learning/all features alike rescaled by powers of two"), 7, 300),
    Check("rounding", learning.rounding, ("learning/features changed by 1e-15",), 4, 100),
    Check("standardised_columns", learning.standardised_columns, ("learning/standardised columns against exact rationals",), 20, 300),
    Check("maps", learning.maps, ("learning/map units stay within their touches",), 6, 100),
    Check("tilted_walls", precision.tilted_walls, ("precision/imprint of a plane in closed form",), 5, 300),
    Check("frames", precision.frames, ("precision/frames on the surface",), 2, 100),
    Check("tessellated_spheres", precision.tessellated_spheres, ("precision/tessellated sphere",), 3, 60),
    Check("pressed_spheres", precision.pressed_spheres, ("precision/sphere under the sensor",), 1, 10),
    Check("out_of_reach", precision.out_of_reach, ("precision/values out of reach and beyond full scale",), 5, 300),
    Check("mesh_places", invariance.places, ("invariance/vertices, offset up to 1e6 sizes",), 4, 300),
    Check("mesh_units", invariance.units, ("invariance/vertices, any scale", "invariance/scale by a power of two", *_SENSED), 1, 20),
    Check("mesh_descriptions", invariance.descriptions_of("lopsided"), ("invariance/order, winding, corners, doubled vertices: vertices", *_SENSED), 2, 40),
    Check("kernel_batches", determinism.kernel_batches, (determinism.NAME,), 3, 100),
    Check("touch_batches", determinism.touch_batches, (determinism.NAME,), 3, 150),
    Check("view_batches", determinism.view_batches, (determinism.NAME,), 3, 60),
    Check("broken_files", meshes.broken_files, ("meshes/fuzzed files: crash, hang, NaN or an unclear refusal",), 40, 2600),
    Check("wild_surfaces", meshes.wild_surfaces, ("meshes/random wild surfaces",), 2, 30),
)  # fmt: skip
