"""Which places the sensor can reach: by its way in at its smallest size, whatever it feels there."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sensor.scenes import always, parameter_sets, probes_on, scenes, surfaces
from sensor.shapes import box, joined, sheet

from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor import SensorParameters, touch
from visuohaptic.sensor.reaching import reachable

UP = np.array([[0.0, 0.0, 1.0]])


def reach(caster, point, **parameters):
    return bool(reachable(caster, np.array([point], float), UP, SensorParameters(**parameters))[0])


@pytest.fixture(scope="module")
def table():
    """A slab, a roof high above a part of it, and a thin post on it."""
    slab = box((-0.5, -0.5, -0.1), (0.5, 0.5, 0.0))
    roof = box((0.1, -0.5, 0.4), (0.5, 0.5, 0.5))
    post = box((-0.202, -0.002, 0.0), (-0.198, 0.002, 0.3))
    return RayCaster(joined(slab, roof, post))


def test_a_place_below_a_roof_is_out_of_reach_and_one_beside_it_in_reach(table):
    assert not reach(table, (0.3, 0.0, 0.0))
    assert reach(table, (0.3, 0.0, 0.5))
    assert reach(table, (0.0, 0.3, 0.0))


def test_the_smallest_sensor_must_pass_what_stands_beside_its_place(table):
    for aside, free in ((0.005, False), (0.02, True)):
        assert reach(table, (-0.2 + aside + 0.002, 0.0, 0.0), smallest_size=0.02) == free
    # A finger as large as a palm meets the roof from beside it.
    assert reach(table, (0.08, 0.3, 0.0), smallest_size=0.02)
    assert not reach(table, (0.08, 0.3, 0.0), smallest_size=0.1)


def test_the_roll_of_the_sensor_counts(table):
    """Turned by 45 degrees about the normal, a corner of the square meets the post."""
    place = np.array([[-0.2 + 0.002 + 0.012, 0.0, 0.0]])
    parameters = SensorParameters(smallest_size=0.02, normal="given")
    assert reachable(table, place, UP, parameters)[0]
    turned = np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, np.sqrt(2)]]) / np.sqrt(2)
    slab = table.surface
    caster = RayCaster(type(slab)(slab.vertices @ turned.T, slab.faces, slab.face_colours))
    assert not reachable(caster, place @ turned.T, UP, parameters)[0]


@pytest.mark.parametrize(("height", "free"), [(0.0015, True), (0.0025, False)])
def test_what_stands_no_higher_than_the_tolerance_is_not_met(height, free):
    slab = box((-0.5, -0.5, -0.1), (0.5, 0.5, 0.0))
    step = box((0.004, -0.1, 0.0), (0.1, 0.1, height))
    assert reach(RayCaster(joined(slab, step)), (0.0, 0.0, 0.0)) == free


@settings(max_examples=40)
@given(surfaces(), scenes(), parameter_sets(), st.integers(0, 1000), st.sampled_from([0.01, 2.0]))
def test_only_places_out_of_reach_are_blocked_or_penetrated_whatever_the_depth_range_and_batch(
    surface, scene, parameters, seed, depth
):
    caster = RayCaster(surface)
    points, normals, fields = probes_on(surface, 8, seed)
    normals = orient_outwards(caster, points, normals)
    found = reachable(caster, points, normals, parameters)
    states = touch(caster, points, normals, parameters, always(scene), fields).contact_state
    assert not np.isin(states[found], ["blocked", "at_minimum"]).any()
    other = parameters.model_copy(update={"depth_range": depth})
    rows = [slice(row, row + 1) for row in range(8)]
    alone = [reachable(caster, points[row], normals[row], other)[0] for row in rows]
    assert found.tolist() == alone


def test_a_sheet_is_in_reach_from_both_sides():
    caster = RayCaster(sheet(lambda x, _: 0.0 * x, cells=8))
    points = np.array([[0.01, 0.0, 0.02]] * 2)
    sides = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    assert reachable(caster, points, sides, SensorParameters()).all()
