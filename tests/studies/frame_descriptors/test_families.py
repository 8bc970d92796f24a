"""Families of descriptors that are the same for all rotations and translations."""

import numpy as np
import pytest
from recognition.synthetic import features_table

from classifier_settings.choose import first_near_best
from frame_descriptors.choose import FAMILIES, MARGIN, describe, read_turned, score
from frame_descriptors.families import local_frames, spectral_moments, triples
from turned.study import STUDY
from visuohaptic.geometry.turning import draw_rotation
from visuohaptic.parameters import as_parameters
from visuohaptic.recognition.descriptors import draw_waves
from visuohaptic.recognition.parameters import OrderFreeParameters
from visuohaptic.studies.conditions import plan_study
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import write_table

WAVES = draw_waves(OrderFreeParameters(), 1)
ALL = FAMILIES["all together"]


def drawn(touches, count=6):
    generator = np.random.default_rng(0)
    points = generator.uniform(-0.7, 0.7, size=(count, touches, 3))
    normals = generator.normal(size=points.shape)
    return points, normals / np.linalg.norm(normals, axis=-1, keepdims=True)


POINTS, NORMALS = drawn(5)
SHAPES = {
    "random": (POINTS, NORMALS),
    "one touch": drawn(1),
    "two touches": drawn(2),
    "equal touches": tuple(np.repeat(part, 5, axis=1) for part in drawn(1)),
    "flat": (POINTS * [1, 0, 1], np.broadcast_to([0.0, 1, 0], NORMALS.shape)),
    "line": (POINTS[..., :1] * [1, 2, 3], NORMALS),
    "tiny": (1e-8 * POINTS, NORMALS),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("family", ALL)
@pytest.mark.parametrize("draw", range(3))
def test_no_rotation_or_translation_changes_a_descriptor(family, shape, draw):
    points, normals = SHAPES[shape]
    rotation = draw_rotation("any", "cup/mug", seed=1, draw=draw)
    before = family(points, normals, WAVES)
    after = family(points @ rotation.T + [0.3, -0.8, 0.5], normals @ rotation.T, WAVES)
    assert np.isfinite(before).all()
    np.testing.assert_allclose(after, before, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("family", ALL)
def test_the_order_of_touches_changes_no_descriptor(family, shape):
    points, normals = SHAPES[shape]
    order = np.random.default_rng(3).permutation(points.shape[1])
    before, after = (
        family(points[:, index], normals[:, index], WAVES)
        for index in (np.arange(points.shape[1]), order)
    )
    np.testing.assert_allclose(after, before, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("family", ALL)
def test_normals_of_other_points_change_descriptors(family):
    difference = family(POINTS, NORMALS[:, ::-1], WAVES) - family(POINTS, NORMALS, WAVES)
    assert np.abs(difference).max() > 0.01


def test_the_triangle_of_a_cube_s_corner():
    corner = np.eye(3)[None]
    found = triples(corner, corner, WAVES)[0, :7]
    side = np.sqrt(2)
    expected = [side, side, side, 1 / np.sqrt(3), 1 / np.sqrt(3), 1, np.sqrt(3) / 2]
    assert found == pytest.approx(expected)


def test_a_neighbour_lies_ahead_in_the_local_frame_of_a_plane():
    points = np.array([[[0.0, 0, 0], [0.5, 0, 0]]])
    normals = np.array([[[0.0, 0, 1], [0.0, 0, 1]]])
    assert local_frames(points, normals, WAVES)[0, :6] == pytest.approx([0, 0.5, 0, 1, 0, 0])


def test_equal_touches_have_the_spectrum_of_one():
    found = spectral_moments(*SHAPES["equal touches"], WAVES)[:, -18:]
    np.testing.assert_allclose(found, 1)


def test_only_objects_of_the_half_are_read_and_scored(tmp_path):
    run = as_parameters({"meshes.set": "benchmark"})
    planned = plan_study(STUDY, run).conditions
    (key,) = (one.key for one in planned if one.condition.name == "any 3 none 5")
    path = tmp_path / "study_features/turned" / f"{key}.parquet"
    write_table(FEATURES, features_table(objects=(6, 6), viewpoints=2, separation=3.0), path)
    half = {f"class{place}/object{number}" for place in (0, 1) for number in range(5)}
    sequences = read_turned(tmp_path, 3, half)
    assert {"/".join(owner) for owner in sequences.objects} == half
    rows = describe(sequences, FAMILIES["spectral moments"], WAVES)
    assert rows.shape[0] == 20
    assert score(rows, sequences) > 0.8


def test_a_family_of_fewer_numbers_is_taken_if_it_is_hardly_behind():
    assert first_near_best({"few": 0.560, "some": 0.561, "many": 0.5649}, MARGIN) == "few"
    assert first_near_best({"few": 0.559, "some": 0.561, "many": 0.5649}, MARGIN) == "some"
