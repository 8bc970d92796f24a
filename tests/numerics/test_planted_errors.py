"""Every check finds an error that is planted in what it checks, and draws the same cases each time."""

import importlib

import numpy as np
import pyarrow as pa
import pytest
from numerics.checks import CHECKS, Check, run_check
from numerics.hard_cases import learning, meshes
from stability.errors import plant

from visuohaptic.stability.findings import Finding

BY_NAME = {check.name: check for check in CHECKS}
CHECKED = {
    "random_triangles": ("rays", "RayCaster"),
    "vertices_and_edges": ("rays", "RayCaster"),
    "leaks": ("rays", "RayCaster"),
    "grazing": ("rays", "RayCaster"),
    "within_a_plane": ("rays", "RayCaster"),
    "slivers": ("rays", "RayCaster"),
    "coplanar": ("rays", "RayCaster"),
    "off_centre": ("rays", "RayCaster"),
    "bands": ("images", "directional_deviations"),
    "reconstruction": ("images", "reconstruction_errors"),
    "flat_images": ("images", "directional_deviations"),
    "images_in_other_units": ("images", "directional_deviations"),
    "sequence_moments": ("images", "summarise_signals"),
    "wavelets": ("images", "wavelet_levels"),
    "imprint_shapes": ("images", "describe_imprint_shape"),
    "stretched_imprints": ("images", "stretch"),
    "hard_views": ("attention", "attend"),
    "noisy_views": ("attention", "attend"),
    "views_from_within": ("attention", "attend"),
    "brightness": ("attention", "attend"),
    "inhibition": ("attention", "scan"),
    "pyramids": ("attention", "blur"),
    "sphere_curvature": ("attention", "measure_shape"),
    "classifiers": ("learning", "predict_quietly"),
    "feature_units": ("learning", "fit_sequence_encoder"),
    "standardised_columns": ("learning", "fit_standardiser"),
    "maps": ("learning", "fit_batch_map"),
    "tilted_walls": ("precision", "touch"),
    "frames": ("precision", "row_axes"),
    "tessellated_spheres": ("precision", "RayCaster"),
    "pressed_spheres": ("precision", "touch"),
    "out_of_reach": ("precision", "touch"),
    "mesh_places": ("invariance", "normalise"),
    "mesh_units": ("invariance", "normalise"),
    "mesh_descriptions": ("invariance", "normalise"),
    "touch_batches": ("determinism", "touch"),
    "view_batches": ("determinism", "attend"),
    "broken_files": ("meshes", "normalise"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CHECKED)
def test_an_error_in_what_is_checked_is_found(monkeypatch, no_caches, name):
    module, function = CHECKED[name]
    module = importlib.import_module(f"numerics.hard_cases.{module}")
    plant(monkeypatch, module, function)
    found = run_check(BY_NAME[name], 1, BY_NAME[name].draws)
    assert found
    assert not all(result.held for result in found.values())


def test_a_kernel_that_depends_on_its_batch_is_found(monkeypatch):
    from numerics.hard_cases import determinism

    monkeypatch.setitem(
        determinism.KERNELS, "moments", lambda images: images.mean(axis=(1, 2)) + len(images)
    )
    (result,) = run_check(BY_NAME["kernel_batches"], 1, 1).values()
    assert not result.held
    assert result.hardest.startswith("moments")


@pytest.mark.parametrize("stable", [True, False])
def test_answers_that_rounding_changes_are_found(monkeypatch, stable):
    def predict_sequences(training, labels, tested, classifier):
        decided_by = tested.sum(axis=(1, 2))
        return tested, np.rint(decided_by if stable else decided_by * 2**50).astype(int) % 2

    monkeypatch.setattr(learning, "predict_sequences", predict_sequences)
    (result,) = run_check(BY_NAME["rounding"], 1, 2).values()
    assert result.held == stable


def test_a_chain_that_ends_without_features_is_found(monkeypatch):
    monkeypatch.setattr(meshes, "run_chain", lambda *_: {"features": pa.table({"x": []})})
    (result,) = run_check(BY_NAME["wild_surfaces"], 1, 1).values()
    assert not result.held


def test_every_check_is_one_that_can_fail():
    assert set(CHECKED) | {"kernel_batches", "rounding", "wild_surfaces"} == set(BY_NAME)
    assert len(BY_NAME) == len(CHECKS)


def test_the_same_seed_draws_the_same_cases():
    check = BY_NAME["sequence_moments"]
    assert run_check(check, 5, 3) == run_check(check, 5, 3)
    assert run_check(check, 5, 3) != run_check(check, 6, 3)


def test_a_check_that_breaks_off_exceeds_all_its_tolerances_and_says_why():
    def measure(generator):
        yield Finding("rays/grazing", 0.0, "well")
        raise ZeroDivisionError("planted")

    check = Check("planted", measure, ("rays/grazing", "images/stretched imprints"), 1, 1)
    found = run_check(check, 1, 2)
    assert list(found) == ["rays/grazing", "images/stretched imprints"]
    for result in found.values():
        assert not result.held
        assert result.hardest == "ended in ZeroDivisionError: planted (draw 0)"
