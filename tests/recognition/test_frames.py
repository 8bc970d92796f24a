"""What descriptors know of the object's frame: what they may not know does not reach them."""

import numpy as np
import pytest
from recognition.synthetic import features_table

from visuohaptic import recognition
from visuohaptic.base.errors import RecognitionError
from visuohaptic.geometry.turning import draw_rotation
from visuohaptic.recognition import frames
from visuohaptic.recognition.descriptors import POSE, describe_sequences, draw_waves
from visuohaptic.recognition.frames import (
    both_ways,
    embed,
    embed_rigid,
    pair_touches,
    principal_extents,
    turning_relations,
)
from visuohaptic.recognition.parameters import OrderFreeParameters, RecognitionParameters
from visuohaptic.tables.phases import CONTOURLET_FEATURES, IMPRINT_FEATURES

FRAMES = ("none", "centre", "vertical", "full")
NAMES = (*CONTOURLET_FEATURES, *IMPRINT_FEATURES, "sensor_size", "contact_full", *POSE)
POSES = ("pose", "relations", "embedding")
PARTS = ("position", "normal")
WAVES = draw_waves(OrderFreeParameters(), 1)
TOLERANCE = 1e-9

CUBE = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)]) / np.sqrt(3)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def drawn(touches, seed=0, count=6):
    generator = np.random.default_rng(seed)
    points = generator.uniform(-0.7, 0.7, size=(count, touches, 3))
    return points, unit(generator.normal(size=points.shape))


def flat():
    points, normals = drawn(5)
    return points * [1, 0, 1], np.broadcast_to([0.0, 1.0, 0.0], normals.shape).copy()


def line():
    points, normals = drawn(5)
    return points[:, :, :1] * unit(np.array([1.0, 2, 3])), normals


SHAPES = {
    "random": drawn(5),
    "two touches": drawn(2),
    "sixteen touches": drawn(16),
    "one touch": drawn(1),
    "equal touches": tuple(np.repeat(part, 5, axis=1) for part in drawn(1)),
    "flat": flat(),
    "line": line(),
    "tiny": (1e-8 * drawn(5)[0], drawn(5)[1]),
    "symmetric": (CUBE[None], CUBE[None]),
    "on the axis": (drawn(5)[0] * [0, 1, 0], drawn(5)[1]),
    "at the centre": (0 * drawn(5)[0], drawn(5)[1]),
}


def describe(points, normals, frame, cues=POSES):
    own = RecognitionParameters(frame=frame, order_free=OrderFreeParameters(cues=cues))
    pose = np.concatenate([points, normals], axis=-1)
    return describe_sequences(pose, POSE, WAVES, own)


def moved(points, normals, turns, shift, draw=0):
    rotation = draw_rotation(turns, "cup/mug", seed=1, draw=draw)
    return points @ rotation.T + shift, normals @ rotation.T


def change(points, normals, frame, turns, shift, draw=0, cues=POSES):
    """Return the largest change of a descriptor, relative to its size, or absolute below 1."""
    before = describe(points, normals, frame, cues)
    after = describe(*moved(points, normals, turns, shift, draw), frame, cues)
    return (np.abs(after - before) / np.maximum(1, np.abs(before))).max()


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("draw", range(5))
@pytest.mark.parametrize(
    ("frame", "turns", "shift"),
    [
        ("none", "any", [0.3, -0.8, 0.5]),
        ("centre", "any", [0.0, 0, 0]),
        ("vertical", "vertical", [0.0, 0, 0]),
    ],
)
def test_what_a_frame_does_not_know_changes_no_descriptor(frame, turns, shift, draw, shape):
    assert change(*SHAPES[shape], frame, turns, np.array(shift), draw) < TOLERANCE


@pytest.mark.parametrize(
    ("frame", "turns", "shift", "cue"),
    [
        *(("centre", "none", [0.1, 0, 0], cue) for cue in POSES),
        *(("vertical", "any", [0.0, 0, 0], cue) for cue in POSES),
        ("vertical", "none", [0.0, 0.1, 0], "pose"),
        ("vertical", "none", [0.0, 0.1, 0], "embedding"),
        ("full", "vertical", [0.0, 0, 0], "pose"),
        ("full", "vertical", [0.0, 0, 0], "embedding"),
    ],
)
def test_what_a_frame_knows_changes_descriptors(frame, turns, shift, cue):
    assert change(*SHAPES["random"], frame, turns, np.array(shift), cues=(cue,)) > 0.01


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("cue", PARTS)
@pytest.mark.parametrize(
    ("frame", "turns", "shift"),
    [
        ("none", "any", [0.3, -0.8, 0.5]),
        ("centre", "any", [0.0, 0, 0]),
        ("vertical", "vertical", [0.0, 0, 0]),
    ],
)
def test_parts_of_the_pose_know_no_more_of_the_frame_than_the_pose(frame, turns, shift, cue, shape):
    assert change(*SHAPES[shape], frame, turns, np.array(shift), cues=(cue,)) < TOLERANCE


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("frame", FRAMES)
def test_positions_tell_nothing_of_normals_and_normals_nothing_of_positions(frame, shape):
    points, normals = SHAPES[shape]
    other_points, other_normals = drawn(points.shape[1], seed=7, count=len(points))
    for cue, same, changed in (
        ("position", (points, other_normals), (other_points, normals)),
        ("normal", (other_points, normals), (points, other_normals)),
    ):
        before = describe(points, normals, frame, (cue,))
        np.testing.assert_array_equal(describe(*same, frame, (cue,)), before)
        if shape == "random":
            assert np.abs(describe(*changed, frame, (cue,)) - before).max() > 0.01


def test_positions_and_normals_are_found_in_known_descriptors():
    points, normals = drawn(5)
    position, normal = (describe(points, normals, "full", (cue,)) for cue in PARTS)
    pose = describe(points, normals, "full", ("pose",))
    # Of a pose's first statistic, the means: three coordinates, then three parts of the normal.
    np.testing.assert_array_equal(position[:, :3], points.mean(axis=1))
    np.testing.assert_array_equal(position[:, :3], pose[:, :3])
    np.testing.assert_array_equal(normal[:, 3:6], normals.mean(axis=1))
    assert not position[:, 3:6].any()
    assert not normal[:, :3].any()


@pytest.mark.parametrize("frame", FRAMES)
def test_no_frame_overlooks_that_normals_belong_to_other_points(frame):
    points, normals = SHAPES["random"]
    difference = describe(points, normals[:, ::-1], frame) - describe(points, normals, frame)
    assert np.abs(difference).max() > 0.01


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("frame", FRAMES)
def test_descriptors_are_finite_and_do_not_depend_on_the_order_of_touches(frame, shape):
    points, normals = SHAPES[shape]
    described = describe(points, normals, frame)
    assert np.isfinite(described).all()
    order = np.random.default_rng(3).permutation(points.shape[1])
    again = describe(points[:, order], normals[:, order], frame)
    np.testing.assert_allclose(again, described, atol=TOLERANCE)


@pytest.mark.parametrize("frame", FRAMES)
def test_the_number_of_descriptors_is_the_same_for_any_number_of_touches(frame):
    counts = {describe(*drawn(touches), frame).shape[1] for touches in (1, 2, 5, 16)}
    assert len(counts) == 1


def test_a_touch_by_itself_has_no_pose_without_a_frame():
    with pytest.raises(RecognitionError, match="no descriptor of the cues pose in frame none"):
        describe(*drawn(5), "none", cues=("pose",))


@pytest.mark.parametrize("frame", FRAMES)
def test_a_row_is_the_same_bit_for_bit_beside_other_sequences_and_in_blocks(frame, monkeypatch):
    points, normals = drawn(5, count=40)
    described = describe(points, normals, frame)
    np.testing.assert_array_equal(describe(points[7:9], normals[7:9], frame), described[7:9])
    monkeypatch.setattr(frames, "WAVES_AT_ONCE", 1)
    np.testing.assert_array_equal(describe(points, normals, frame), described)


def test_point_pair_features_of_two_faces_of_a_box():
    points = np.array([[[0.0, 0, 0], [3.0, 4, 0]]])
    normals = np.array([[[1.0, 0, 0], [0.0, 1, 0]]])
    pairs = pair_touches(points, normals, np.array([0]), np.array([1]))
    found = [pairs.distance, pairs.leaving, pairs.arriving, pairs.agreement]
    assert [part.item() for part in found] == pytest.approx([5, 0.6, 0.8, 0])


def test_products_of_embedded_pairs_tend_to_the_gaussian_kernel():
    own = OrderFreeParameters(waves=5000, wave_length=0.5, normal_weight=0.25)
    many = draw_waves(own, 2)
    points, normals = drawn(2, count=8)
    embedded = embed_rigid(points, normals, many)
    pairs = both_ways(points, normals)
    cosines = [pairs.leaving, pairs.arriving, pairs.agreement]
    values = np.stack([pairs.distance, *(0.25 * one for one in cosines)], axis=-1)
    squares = np.square(values[:, None, :, None] - values[None, :, None]).sum(axis=-1)
    expected = np.exp(-squares / (2 * 0.5**2)).mean(axis=(2, 3))
    # A mean of 5000 terms of variance at most 1.5 is within .1 at more than five sigma.
    np.testing.assert_allclose(embedded @ embedded.T / 5000, expected, atol=0.1)


def test_without_pairs_the_embedding_is_zero():
    assert (embed(np.zeros((3, 0, 6)), WAVES) == 0).all()


def test_points_of_a_plane_have_no_extent_across_it_not_even_by_rounding():
    generator = np.random.default_rng(0)
    plane = generator.normal(size=(200, 2, 3))
    points = np.einsum("sti,sij->stj", generator.normal(size=(200, 5, 2)), plane)
    extents = principal_extents(points)
    assert (extents[:, 0] == 0).all()
    assert (extents[:, 1:] > 1e-3).all()


def test_a_screw_turns_the_other_way_in_a_mirror():
    angles = np.array([0.0, 1.0])
    points = np.stack([np.cos(angles), [0.0, 0.5], np.sin(angles)], axis=-1)[None]
    right, left = turning_relations(points)[0], turning_relations(points * [1, 1, -1])[0]
    assert right[:3] == pytest.approx([np.cos(1), np.sin(1), 0.5 * np.sin(1)])
    assert left[:3] == pytest.approx([np.cos(1), np.sin(1), -0.5 * np.sin(1)])


def rolled(values, generator):
    """Roll the sensor of each touch: shift its bands, and swap rows and columns of every second imprint."""
    values = values.copy()
    bands = values[..., :16].reshape(-1, 16)
    steps = generator.integers(1, 16, size=len(bands))
    index = (np.arange(16) - steps[:, None]) % 16
    values[..., :16] = np.take_along_axis(bands, index, axis=1).reshape(values[..., :16].shape)
    values[:, ::2, NAMES.index("imprint_upright_bending")] *= -1
    for name in ("tilt", "step"):
        pair = [NAMES.index(f"imprint_{name}_{axis}") for axis in ("columns", "rows")]
        values[:, ::2, pair] = values[:, ::2, pair[::-1]]
    return values


@pytest.mark.parametrize(
    ("frame", "is_felt"), [("none", False), ("centre", False), ("vertical", True), ("full", True)]
)
def test_the_roll_of_the_sensor_reaches_only_frames_with_a_vertical(frame, is_felt):
    generator = np.random.default_rng(0)
    values = generator.uniform(size=(6, 5, len(NAMES)))
    own = RecognitionParameters(frame=frame)
    before = describe_sequences(values, NAMES, WAVES, own)
    after = describe_sequences(rolled(values, generator), NAMES, WAVES, own)
    difference = np.abs(after - before).max()
    assert difference > 0.1 if is_felt else difference < TOLERANCE


@pytest.mark.parametrize("frame", ["none", "centre"])
def test_bands_that_are_not_sixteen_directions_are_refused_in_a_sentence(frame):
    names = (*CONTOURLET_FEATURES[:13], *POSE)
    values = np.zeros((2, 5, len(names)))
    sentence = r"frame none and centre need the 16 directional bands .* the features have 13"
    with pytest.raises(RecognitionError, match=sentence):
        describe_sequences(values, names, WAVES, RecognitionParameters(frame=frame))
    describe_sequences(values, names, WAVES, RecognitionParameters(frame="vertical"))


@pytest.mark.parametrize("frame", FRAMES)
def test_a_saved_model_knows_its_frame_and_names_a_column_that_it_lacks(frame, tmp_path):
    table = features_table(objects=(3, 3), separation=3.0)
    own = RecognitionParameters(frame=frame)
    model = recognition.fit_model(table, "order_free", "linear_discriminant", own, 1)
    recognition.save_model(model, tmp_path / "m.skops")
    loaded = recognition.load_model(tmp_path / "m.skops")
    assert loaded.parameters.frame == frame
    unseen = features_table(objects=(1,), seed=7)
    assert loaded.answer(unseen) == model.answer(unseen)
    with pytest.raises(RecognitionError, match="contourlet_09"):
        loaded.answer(unseen.drop_columns(["contourlet_09"]))


def test_a_model_without_the_vertical_does_not_take_touches_whose_last_bands_are_empty():
    table = features_table(objects=(3, 3), separation=3.0)
    own = RecognitionParameters(frame="none")
    model = recognition.fit_model(table, "order_free", "linear_discriminant", own, 1)
    unseen = features_table(objects=(1,), seed=7)
    for name in CONTOURLET_FEATURES[13:]:
        place = unseen.schema.get_field_index(name)
        field = unseen.schema.field(place)
        unseen = unseen.set_column(place, field, [np.zeros(unseen.num_rows)])
    with pytest.raises(RecognitionError, match=r"16 directional bands .* the features have 13"):
        model.recognise(unseen)


@pytest.mark.parametrize("frame", ["none", "centre", "vertical"])
def test_turned_touches_get_the_same_answer_of_a_model_that_does_not_know_the_turn(frame):
    table = features_table(objects=(3, 3), separation=3.0)
    own = RecognitionParameters(frame=frame)
    model = recognition.fit_model(table, "order_free", "linear_discriminant", own, 1)
    unseen = features_table(objects=(1,), seed=7)
    rotation = draw_rotation("vertical" if frame == "vertical" else "any", "a/b", seed=3)
    turned = unseen
    for names in (POSE[:3], POSE[3:]):
        values = np.column_stack([unseen.column(name) for name in names]) @ rotation.T
        for name, column in zip(names, values.T, strict=True):
            place = turned.schema.get_field_index(name)
            turned = turned.set_column(place, turned.schema.field(place), [column])
    expected = model.recognise(unseen)
    assert model.recognise(turned) == pytest.approx(expected, rel=1e-6, abs=1e-12)
