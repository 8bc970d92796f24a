"""Pads of other layouts than the square: closed forms, approach, symmetry, and the chain of effects per taxel."""

import warnings

import numpy as np
import pytest
from sensor import closed_forms
from sensor.shapes import box, joined, surface_of

from visuohaptic.base.errors import LayoutWarning, ParameterError
from visuohaptic.geometry.layouts import Layout, build_layout, grid_layout
from visuohaptic.geometry.pads import layout_of
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor import parameters as sensor_parameters
from visuohaptic.sensor.example_shapes import revolve, sheet
from visuohaptic.sensor.imprints import make_poses
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import CLEARANCE, PENETRATION_TOLERANCE, place_batch
from visuohaptic.sensor.random_fields import RandomFields
from visuohaptic.sensor.reaching import reachable
from visuohaptic.sensor.sensing import touch

UP = np.array([[0.0, 1.0, 0.0]])
ORIGIN = np.zeros((1, 3))
PADS = ("round", "dome", "finger", "gripper")


def placed(surface, layout, mode="auto", **values):
    parameters = SensorParameters(layout=layout, **values)
    return place_batch(RayCaster(surface), make_poses(ORIGIN, UP), parameters, mode)


def rests(surface, layout):
    """Height at which the pad of the largest size rests."""
    return float(np.clip(placed(surface, layout, "never").highest[0], 0, CLEARANCE))


def felt_by(surface, layout="square", scene=None, seed=3, **values):
    parameters = SensorParameters(layout=layout, normal="given", **values)
    fields = RandomFields(seed, [("one", 0)])
    return touch(RayCaster(surface), ORIGIN, UP, parameters, scene or Scene(), fields)


def wavy(x, z):
    return 0.02 * np.sin(31 * x + 0.4) * np.cos(23 * z) - 0.3 * x**2 - 0.02 * np.sin(0.4)


@pytest.mark.parametrize("shape", closed_forms.SHAPES)
@pytest.mark.parametrize("preset", closed_forms.PRESETS)
def test_heights_are_those_of_the_closed_form_up_to_the_mesh(preset, shape):
    # The object between the pads of a gripper is narrower than the gripper.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LayoutWarning)
        found, deep = closed_forms.errors(preset, shape)
    assert found.max() <= deep


def test_a_grid_as_given_taxels_feels_what_the_square_feels_bit_for_bit(monkeypatch):
    surface = sheet(wavy, 0.4, 80)
    for scene in (Scene(), Scene(preset="fsr400", readout="ideal")):
        grid = grid_layout(16, 16)
        square = felt_by(surface, scene=scene, resolution=16)
        own = build_layout("own", grid.positions, grid.directions, extents=(1.0, 1.0))
        monkeypatch.setattr(sensor_parameters, "layout_of", lambda *_, own=own: own)
        flat = felt_by(surface, scene=scene, resolution=16)
        monkeypatch.undo()
        assert flat.images.shape == (1, 256)
        for name in ("size", "contact_state", "penetration", "normals", "tangents"):
            np.testing.assert_array_equal(getattr(flat, name), getattr(square, name))
        np.testing.assert_array_equal(flat.gaps.ravel(), square.gaps.ravel())
        np.testing.assert_array_equal(flat.images.ravel(), square.images.ravel())


@pytest.mark.parametrize("preset", PADS)
def test_readings_do_not_depend_on_the_order_of_taxels(preset, monkeypatch):
    surface, layout = sheet(wavy, 0.4, 80), layout_of(preset, 2)
    order = np.random.default_rng(5).permutation(len(layout))
    one = felt_by(surface, preset)
    shuffled = build_layout(
        "own", layout.positions[order], layout.directions[order], extents=layout.extents
    )
    monkeypatch.setattr(sensor_parameters, "layout_of", lambda *_: shuffled)
    other = felt_by(surface, preset)
    np.testing.assert_array_equal(one.images[:, order], other.images)
    np.testing.assert_array_equal(one.size, other.size)
    np.testing.assert_array_equal(one.contact_state, other.contact_state)


@pytest.mark.parametrize("preset", PADS)
def test_a_mirrored_object_gives_the_readings_of_the_mirrored_taxels(preset, monkeypatch):
    layout = layout_of(preset, 2)
    surface = sheet(wavy, 0.4, 80)
    mirrored = surface_of(surface.vertices * [-1, 1, 1], surface.faces[:, ::-1])
    # Frames are upright here: columns along +x. So a mirrored x is a mirrored column.
    one = felt_by(surface, preset)
    signs = np.array([-1.0, 1, 1])
    own = build_layout(
        "own", layout.positions * signs, layout.directions * signs, extents=layout.extents
    )
    monkeypatch.setattr(sensor_parameters, "layout_of", lambda *_: own)
    other = felt_by(mirrored, preset)
    np.testing.assert_allclose(one.gaps, other.gaps, atol=1e-12)
    np.testing.assert_array_equal(one.size, other.size)


def test_a_pad_of_six_fold_symmetry_turned_by_its_step_permutes_its_readings(monkeypatch):
    layout = layout_of("dome", 2)
    surface = sheet(wavy, 0.4, 80)
    one = felt_by(surface, "dome")
    turn = np.radians(60)
    matrix = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    positions, directions = layout.positions @ matrix.T, layout.directions @ matrix.T
    twin = np.linalg.norm(positions[:, None] - layout.positions[None], axis=2).argmin(axis=1)
    assert sorted(twin.tolist()) == list(range(127))
    turned = build_layout("own", positions, directions, extents=layout.extents)
    monkeypatch.setattr(sensor_parameters, "layout_of", lambda *_: turned)
    np.testing.assert_allclose(felt_by(surface, "dome").gaps, one.gaps[:, twin], atol=1e-12)


@pytest.mark.parametrize("preset", ["dome", "finger"])
@pytest.mark.parametrize("aside", [0.02, 0.034, 0.05, 0.068])
def test_a_curved_pad_rests_where_its_first_point_meets_a_step(preset, aside):
    """A step of height h at the distance a from the touched point holds a round pad of radius r up by h - z(a)."""
    height = 0.06
    step = joined(
        box((-0.5, -0.2, -0.5), (0.5, 0, 0.5)), box((aside, -0.2, -0.5), (0.5, height, 0.5))
    )
    radius = 0.15 if preset == "dome" else 0.7 * 0.15
    exact = height - (radius - np.sqrt(radius**2 - aside**2))
    # Between checked points the pad may sink by the sag between two of them: the rings, or columns, halved.
    step_angle = np.radians(75 / 6 / 2 if preset == "dome" else 15 / 2)
    next_angle = np.arcsin(aside / radius) + step_angle
    lowest = height - radius * (1 - np.cos(next_angle))
    assert lowest - 1e-12 <= rests(step, preset) <= exact + 1e-12


def test_points_between_taxels_find_a_needle_that_no_taxel_meets(monkeypatch):
    dome = layout_of("dome", 2)
    between = 0.15 * dome.approach.positions[len(dome) + 40]
    x, z = between[0], -between[1]
    needle = joined(
        box((-0.5, -0.2, -0.5), (0.5, 0, 0.5)),
        box((x - 1e-4, -0.1, z - 1e-4), (x + 1e-4, 0.09, z + 1e-4)),
    )
    assert rests(needle, "dome") == pytest.approx(0.09 - between[2], abs=1e-6)
    axial = np.tile([0.0, 0, -1], (len(dome), 1))
    taxels_only = build_layout("taxels", dome.positions, axial, extents=(1.0, 1.0))
    blind = Layout(**{**vars_of(dome), "name": "blind"})
    blind.__dict__["approach"] = taxels_only
    monkeypatch.setattr(sensor_parameters, "layout_of", lambda *_: blind)
    assert rests(needle, "dome") == 0


def vars_of(layout):
    return {name: getattr(layout, name) for name in Layout.__dataclass_fields__}


def test_a_dome_fits_into_a_bowl_that_is_as_round_where_a_square_shrinks():
    angle = np.linspace(0, np.pi / 2, 200)
    bowl = revolve(0.12 * np.sin(angle), 0.12 - 0.12 * np.cos(angle), 180)
    dome, square = (float(placed(bowl, layout).sizes[0]) for layout in ("dome", "square"))
    # A dome of the bowl's radius lies in the bowl everywhere; the tolerance lets a dome of 0.123 in. The search stops
    # within 1/64 of the 0.21 by which the dome shrank.
    assert 0.24 - 0.21 / 64 < dome < 2 * 0.123
    # The corners of a square are in the bowl up to the tolerance, sqrt(2 * 0.12 * 0.002) from the touched point.
    assert square / 2 == pytest.approx(np.sqrt(0.12 * PENETRATION_TOLERANCE), rel=0.02)


@pytest.mark.parametrize("preset", PADS)
def test_admissible_pads_do_not_penetrate_and_places_in_reach_are_admissible(preset):
    generator = np.random.default_rng(2)
    surface = joined(sheet(wavy, 0.4, 60), box((0.06, -0.3, -0.4), (0.1, 0.5, 0.4)))
    places = np.column_stack([generator.uniform(-0.3, 0.05, 12), np.zeros(12), generator.uniform(-0.3, 0.3, 12)])  # fmt: skip
    places[:, 1] = wavy(places[:, 0], places[:, 2])
    parameters = SensorParameters(layout=preset, normal="given")
    normals = np.tile(UP, (12, 1))
    caster = RayCaster(surface)
    batch = place_batch(caster, make_poses(places, normals), parameters, "auto")
    forced = place_batch(caster, make_poses(places, normals), parameters, "always")
    np.testing.assert_array_equal(batch.gaps, forced.gaps)
    grown = (batch.sizes > parameters.smallest_size) & ~batch.blocked
    assert (batch.highest[grown] <= PENETRATION_TOLERANCE).all()
    in_reach = reachable(caster, places, normals, parameters)
    assert in_reach.any()
    states = touch(caster, places, normals, parameters, Scene()).contact_state
    assert not set(states[in_reach].tolist()) & {"blocked", "at_minimum"}


def test_the_search_for_a_size_ends_for_a_taxel_on_the_outline():
    valley = sheet(lambda x, z: 0.8 * np.abs(x) + 0 * z, half=0.4, cells=80)
    row = ((-1.0, 0, 0, 0, 0, -1.0), (1.0, 0, 0, 0, 0, -1.0), (0.0, 0.1, 0, 0, 0, -1.0))
    assert placed(valley, row, smallest_size=1e-3).sizes[0] < 0.02


def test_each_taxel_of_a_dome_has_its_own_pressure_gain_and_noise():
    surface, scene = sheet(wavy, 0.4, 80), {"preset": "fsr400", "readout": "ideal"}
    quiet = Scene(**scene, gain_scatter=0, noise=0, bits=None, break_pressure_pa=0, hysteresis=0)
    felt = felt_by(surface, "dome", quiet, normalisation="absolute")
    press, thick, nu = 0.0005, quiet.cover_thickness_m, quiet.cover_poisson_ratio
    overlap = np.maximum(press - quiet.object_radius_m * np.maximum(felt.gaps, 0), 0)
    stiffness = quiet.cover_modulus_pa * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * thick)
    share = overlap * stiffness / quiet.full_scale_pressure_pa
    limit = quiet.full_scale_pressure_pa / quiet.saturation_pressure_pa
    expected = np.clip(share * (1 + limit) / (1 + limit * share), 0, 1)
    assert 0 < (expected > 0).sum() < 127
    np.testing.assert_allclose(felt.images, expected, atol=1e-6)
    loud = [felt_by(surface, "dome", Scene(**scene), seed=seed).images for seed in (3, 3, 4)]
    np.testing.assert_array_equal(loud[0], loud[1])
    assert (loud[0] != loud[2]).any()


@pytest.mark.parametrize(
    ("scene", "says"),
    [
        ({"readout": "floating"}, "scene.readout is floating, which needs a square grid .* 127 taxels; scene.readout: ideal"),
        ({"cover": "half_space"}, "scene.cover is half_space, .*; scene.cover: winkler works on any layout"),
    ],
)  # fmt: skip
def test_effects_that_need_rows_and_columns_are_refused_in_a_sentence(scene, says):
    with pytest.raises(ParameterError, match=says):
        felt_by(sheet(wavy, 0.4, 20), "dome", Scene(**scene))


@pytest.mark.parametrize("preset", ["ideal", "fsr400", "worn_fsr"])
def test_effects_that_no_touch_of_a_pad_needs_change_no_bit(preset):
    scene = Scene(preset=preset, readout="ideal")
    surface = sheet(wavy, 0.4, 40)
    auto, always = (felt_by(surface, "dome", one) for one in (scene, scene.with_effects("always")))
    np.testing.assert_array_equal(auto.images, always.images)


def test_the_reach_of_rays_of_a_curved_pad_ends_within_the_pad():
    """A sheet beyond the pad's axis is not felt through the pad."""
    ground = sheet(lambda x, z: 0 * x, 0.5, 4)
    fence = box((-0.2, 0.12, -0.5), (-0.16, 0.4, 0.5))
    alone, fenced = (felt_by(surface, "dome") for surface in (ground, joined(ground, fence)))
    beyond = layout_of("dome", 2).positions[:, 0] > 0.05
    np.testing.assert_array_equal(alone.images[:, beyond], fenced.images[:, beyond])


def test_a_taxel_below_the_origin_is_kept_out_of_a_plate_whatever_the_mode():
    plate = box((-0.5, -0.3, -0.5), (0.5, 0, 0.5))
    probe = ((-1.0, 0, 0, 0, 0, -1.0), (1.0, 0, 0, 0, 0, -1.0), (0.0, 0.5, -0.3, 0, 0, -1.0))
    auto, always, never = (placed(plate, probe, mode) for mode in ("auto", "always", "never"))
    assert never.highest[0] == pytest.approx(0.3 * 0.15)
    assert never.gaps[0] == pytest.approx([0.3 * 0.15, 0.3 * 0.15, 0])
    np.testing.assert_array_equal(auto.sizes, always.sizes)
    # The tolerance lets the tip in by 0.002: a pad 2 * 0.002 / 0.3 wide, which is less than the smallest.
    assert auto.sizes[0] == 0.02
