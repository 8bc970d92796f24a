"""Every check, how often it draws, and what it is about."""

from collections.abc import Callable
from dataclasses import dataclass, replace

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

from visuohaptic.base.seeds import spawn_generator
from visuohaptic.stability.findings import merge_results, results_of


@dataclass(frozen=True)
class Check:
    """A way to draw hard cases and measure their errors.

    `about` is the name, in the check's module, of what it measures: an error planted in it must be found.
    """

    measure: Callable
    draws: int
    full_draws: int
    about: str = ""

    @property
    def name(self):
        return self.measure.__name__


def run_check(check, seed, draws):
    """Draw a check's cases and give the worst of each tolerance."""
    return merge_results(_results(check, seed, draws))


def holds(check, seed, draws):
    """Tell whether every error is within its tolerance; a check that breaks off does not hold."""
    try:
        return all(result.held for result in _results(check, seed, draws))
    except Exception:  # noqa: BLE001 broken code may fail in any way
        return False


def _results(check, seed, draws):
    for number in range(draws):
        generator = spawn_generator(seed, "stability", check.name, number)
        for result in results_of(check.measure(generator), TOLERANCES):
            yield replace(result, hardest=f"{result.hardest} (draw {number})")


_ALL = (
    Check(rays.random_triangles, 20, 300, "RayCaster"),
    Check(rays.vertices_and_edges, 3, 100, "RayCaster"),
    Check(rays.leaks, 6, 200, "RayCaster"),
    Check(rays.grazing, 20, 300, "RayCaster"),
    Check(rays.within_a_plane, 4, 30, "RayCaster"),
    Check(rays.slivers, 4, 40, "RayCaster"),
    Check(rays.coplanar, 1, 20, "RayCaster"),
    Check(rays.off_centre, 10, 300, "RayCaster"),
    Check(images.bands, 1, 1, "directional_deviations"),
    Check(images.reconstruction, 1, 1, "reconstruction_errors"),
    Check(images.flat_images, 10, 300, "directional_deviations"),
    Check(images.images_in_other_units, 10, 300, "directional_deviations"),
    Check(images.sequence_moments, 40, 1000, "summarise_signals"),
    Check(images.wavelets, 10, 300, "wavelet_levels"),
    Check(images.imprint_shapes, 6, 300, "describe_imprint_shape"),
    Check(images.stretched_imprints, 6, 100, "stretch"),
    Check(attention.hard_views, 20, 600, "attend"),
    Check(attention.noisy_views, 10, 300, "attend"),
    Check(attention.views_from_within, 3, 50, "attend"),
    Check(attention.brightness, 6, 300, "attend"),
    Check(attention.inhibition, 10, 300, "scan"),
    Check(attention.pyramids, 10, 300, "blur"),
    Check(attention.sphere_curvature, 1, 6, "measure_shape"),
    Check(learning.classifiers, 7, 100, "predict_quietly"),
    Check(learning.feature_units, 7, 300, "encode_sequences"),
    Check(learning.rounding, 4, 100),
    Check(learning.standardised_columns, 20, 300, "fit_standardiser"),
    Check(learning.maps, 6, 100, "fit_batch_map"),
    Check(precision.tilted_walls, 5, 300, "touch"),
    Check(precision.frames, 2, 100, "row_axes"),
    Check(precision.tessellated_spheres, 3, 60, "RayCaster"),
    Check(precision.pressed_spheres, 1, 10, "touch"),
    Check(precision.out_of_reach, 5, 300, "touch"),
    Check(invariance.mesh_places, 4, 300, "normalise"),
    Check(invariance.mesh_units, 1, 20, "normalise"),
    Check(invariance.mesh_descriptions, 2, 40, "normalise"),
    Check(invariance.branching_edges, 4, 80, "measure_shape"),
    Check(determinism.kernel_batches, 3, 100, "summarise_signals"),
    Check(determinism.touch_batches, 3, 150, "touch"),
    Check(determinism.view_batches, 3, 60, "attend"),
    Check(meshes.broken_files, 40, 2600, "normalise"),
    Check(meshes.wild_surfaces, 2, 30),
)
CHECKS = {check.name: check for check in _ALL}
