import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sensor.scenes import always, parameter_sets, probes_on, scenes, surfaces, with_modes
from sensor.shapes import PLATE, box, hard_probes, joined, sheet

from visuohaptic.base.errors import ParameterError
from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import PRESETS, TACTILE_EFFECTS, Scene
from visuohaptic.sensor import SensorParameters, touch
from visuohaptic.sensor.sensing import place_sensors, sense
from visuohaptic.tables.phases import CONTACT_STATES

ARRAYS = ("images", "size", "contact_state", "penetration", "normals", "tangents", "gaps")


def assert_same_touches(one, other):
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    np.testing.assert_array_equal(np.signbit(one.images), np.signbit(other.images))


def touch_one(surface, point, normal, scene=None, **parameters):
    return touch(
        RayCaster(surface),
        np.array([point], float),
        np.array([normal], float),
        SensorParameters(**parameters),
        Scene() if scene is None else scene,
    )


@pytest.mark.slow
@settings(max_examples=60)
@given(surfaces(), scenes(), scenes(), parameter_sets(), st.integers(0, 1000), st.integers(1, 5))
def test_a_touch_depends_on_its_place_and_scene_alone(surface, scene, other, parameters, seed, cut):
    caster = RayCaster(surface)
    points, normals, fields = probes_on(surface, 6, seed)
    normals = orient_outwards(caster, points, normals)
    felt = touch(caster, points, normals, parameters, scene, fields)
    assert felt.images.dtype == np.float32
    assert np.isfinite(felt.images).all()
    assert ((felt.images >= 0) & (felt.images <= 1)).all()
    assert not np.isnan(felt.gaps).any()
    assert set(felt.contact_state) <= set(CONTACT_STATES)
    assert np.isfinite(felt.penetration).all()
    assert (felt.penetration >= 0).all()

    # Whatever is in the batch,
    for rows in (np.arange(cut), np.arange(cut, 6)[::-1]):
        alone = touch(caster, points[rows], normals[rows], parameters, scene, fields.select(rows))
        for name in ARRAYS:
            np.testing.assert_array_equal(getattr(alone, name), getattr(felt, name)[rows])
    # whatever was felt by sensors that are placed once,
    placed = list(place_sensors(caster, points, normals, parameters, "auto"))
    sense(placed, parameters, other, fields)
    assert_same_touches(sense(placed, parameters, scene, fields), felt)
    # and whether effects that it does not need are simulated.
    eager = touch(caster, points, normals, parameters, always(scene), fields)
    assert_same_touches(felt, eager)
    for skipped, ran in zip(felt.effects, eager.effects, strict=True):
        assert skipped.runs == skipped.needed == ran.needed
        assert ran.runs == ran.touches == 6
        assert skipped.reason == ran.reason


@pytest.mark.parametrize(
    ("name", "state"),
    [
        ("bowl, inside", "shrunk"),
        ("screw thread, crest", "full"),
        ("screw thread, groove", "shrunk"),
        ("cup, inner wall", "blocked"),
        ("cup, floor", "shrunk"),
        ("cup, handle", "partial"),
        ("cup, under the handle", "blocked"),
        ("leaf, rim", "partial"),
        ("cone, tip", "partial"),
    ],
)
def test_hard_shapes_have_the_state_that_they_should(name, state):
    probe = hard_probes()[name]
    assert touch_one(probe.surface, probe.point, probe.normal).contact_state[0] == state


def test_a_crack_too_narrow_for_the_fingertip_is_at_minimum():
    slit = joined(
        box((-0.5, -0.3, -0.5), (-0.004, 0.05, 0.5)),
        box((-0.01, -0.3, -0.5), (0.01, 0, 0.5)),
        box((0.004, -0.3, -0.5), (0.5, 0.05, 0.5)),
    )
    touches = touch_one(slit, (0, 0, 0), (0, 1, 0))
    assert touches.contact_state[0] == "at_minimum"
    assert touches.size[0] == SensorParameters().smallest_size
    assert touches.penetration[0] == pytest.approx(0.05)
    # The rigid sensor rests on both banks and hangs over the crack.
    assert (touches.images[0][:, 0] == 1).all()
    assert (touches.images[0][:, 16] == 0).all()


@pytest.mark.parametrize("normalisation", ["per_imprint", "absolute"])
def test_a_flat_contact_is_contact_all_over_and_relief_below_the_flatness_nearly(normalisation):
    touches = touch_one(PLATE, (0.01, 0, 0), (0, 1, 0), normalisation=normalisation)
    np.testing.assert_array_equal(touches.images, 1)
    assert touches.contact_state[0] == "full"
    ripple = sheet(lambda x, z: 1e-6 * np.sin(60 * x) + 0 * z, half=0.4, cells=80)
    touches = touch_one(ripple, (0, 0, 0), (0, 1, 0), normalisation=normalisation)
    assert touches.images.min() > 0.97


def test_absolute_images_measure_depth_in_depth_ranges():
    roof = sheet(lambda x, z: -0.4 * np.abs(x) + 0 * z, half=0.4, cells=80)
    touches = touch_one(roof, (0, 0, 0), (0, 1, 0), normalisation="absolute", depth_range=0.05)
    x = 0.15 * (2 * np.arange(32) - 31) / 32
    expected = np.clip(1 - 0.4 * np.abs(x) / 0.05, 0, 1)
    np.testing.assert_allclose(touches.images[0], np.tile(expected, (32, 1)), atol=1e-7)
    assert touches.contact_state[0] == "partial"


def test_columns_run_along_the_tangent_and_rows_down():
    """A bump to the right of and above the probed point on a wall that faces +z."""
    wall = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.0))
    ledge = box((0.05, 0.06, -0.1), (0.1, 0.1, 0.03))
    touches = touch_one(
        joined(wall, ledge), (0, 0, 0), (0, 0, 1), with_modes(Scene(), adaptive_size="never")
    )
    np.testing.assert_allclose(touches.tangents, [[1, 0, 0]], atol=1e-12)
    rows, columns = np.nonzero(touches.images[0] == 1)
    assert columns.min() > 16
    assert rows.max() < 16


def test_the_face_under_the_probe_gives_the_normal_where_it_is_named():
    roof = sheet(lambda x, z: -0.4 * np.abs(x) + 0 * z, half=0.4, cells=2)
    caster, face = RayCaster(roof), np.array([0])
    point, own = roof.triangles[face].mean(axis=1), roof.face_normals[face]
    tilted = own + np.array([[0.1, 0.0, 0.2]])
    tilted /= np.linalg.norm(tilted)
    for given_normal, faces, kind, expected in (
        (tilted, face, "face", own),
        (-tilted, face, "face", -own),
        (tilted, face, "given", tilted),
        (tilted, None, "face", tilted),
    ):
        parameters = SensorParameters(normal=kind)
        felt = touch(caster, point, given_normal, parameters, Scene(), faces=faces)
        np.testing.assert_array_equal(felt.normals, expected)


def test_a_random_scene_without_random_fields_is_refused():
    with pytest.raises(ParameterError, match="pass RandomFields"):
        touch_one(PLATE, (0, 0, 0), (0, 1, 0), Scene(noise=0.1))


def test_no_touches_give_empty_arrays_and_records():
    none = np.zeros((0, 3))
    touches = touch(RayCaster(PLATE), none, none, SensorParameters(), Scene())
    assert touches.images.shape == (0, 32, 32)
    assert [record.effect for record in touches.effects] == list(TACTILE_EFFECTS)


@pytest.mark.parametrize("preset", sorted(PRESETS))
def test_presets_call_for_the_effects_that_they_are_about(preset):
    surface = sheet(lambda x, z: -0.3 * x**2 - 0.2 * z**2, half=0.4, cells=40)
    points, normals, fields = probes_on(surface, 5, 0)
    touches = touch(
        RayCaster(surface), points, normals, SensorParameters(), Scene(preset=preset), fields
    )
    ran = {record.effect for record in touches.effects if record.runs}
    new = {"elastic_cover", "force_response", "gain_scatter", "crosstalk", "noise", "quantisation"}
    worn = new | {"hysteresis", "drift", "dead_cells"}
    expected = {"ideal": set(), "fsr400": new, "worn_fsr": worn}
    assert ran - {"adaptive_size"} == expected[preset]


@pytest.mark.slow
def test_ten_thousand_touches_of_a_large_mesh_fit_into_memory():
    surface = sheet(lambda x, z: 0.02 * np.sin(20 * x) * np.sin(20 * z), half=0.7, cells=240)
    assert len(surface.faces) > 100_000
    caster = RayCaster(surface)
    points, normals, fields = probes_on(surface, 10_000, 0)
    noisy, last = Scene(noise=0.01), np.arange(9901, 10_000)
    tracemalloc.start()
    together = touch(caster, points, normals, SensorParameters(), noisy, fields)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2**29
    of_last = fields.select(last)
    alone = touch(caster, points[last], normals[last], SensorParameters(), noisy, of_last)
    np.testing.assert_array_equal(alone.images, together.images[last])


def test_the_largest_depth_range_is_no_limit():
    """Whatever lies below the sensor is felt; a taxel is 0 where nothing lies there at all."""
    post = box((-0.05, -0.05, -0.9), (0.05, 0.05, 0.9))
    foot = box((-0.4, -0.4, -0.95), (0.4, 0.4, -0.9))
    deep, shallow = (
        touch_one(
            joined(post, foot), (0, 0, 0.9), (0, 0, 1), depth_range=depth, normalisation="absolute"
        )
        for depth in (2.0, 0.1)
    )
    assert np.isfinite(deep.gaps).all()
    np.testing.assert_allclose(deep.images.min(), 1 - 1.8 / 2.0, atol=1e-6)
    assert deep.contact_state[0] == "full"
    assert (shallow.images == 0).any()
    assert shallow.contact_state[0] == "partial"


@pytest.mark.parametrize(("share", "state"), [(0.999, "full"), (1.001, "partial")])
def test_a_touch_is_partial_from_the_depth_range_downwards(share, state):
    depth = 0.1
    step = joined(
        box((-0.5, -0.6, -0.5), (0.03, 0, 0.5)),
        box((0.03, -0.6, -0.5), (0.5, -share * depth, 0.5)),
    )
    touches = touch_one(step, (0, 0, 0), (0, 1, 0), depth_range=depth)
    assert touches.contact_state.tolist() == [state]
