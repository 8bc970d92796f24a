import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sensor.scenes import probes_on, surfaces
from sensor.shapes import PLATE, box, hard_probes, joined, sheet, surface_of

from visuohaptic.base.errors import EndlessLoopError
from visuohaptic.geometry.layouts import grid_layout
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor import SensorParameters, placing
from visuohaptic.sensor.imprints import cast_heights, make_poses
from visuohaptic.sensor.placing import PENETRATION_TOLERANCE as TOLERANCE
from visuohaptic.sensor.placing import place_batch

PARAMETERS = SensorParameters()


def placed(surface, point, normal, parameters=PARAMETERS, mode="auto"):
    poses = make_poses(np.array([point], float), np.array([normal], float))
    return place_batch(RayCaster(surface), poses, parameters, mode)


def test_a_valley_admits_a_square_that_its_walls_just_touch():
    valley = sheet(lambda x, z: 0.8 * np.abs(x) + 0 * z, half=0.4, cells=80)
    placement = placed(valley, (0, 0, 0), (0, 1, 0))
    assert placement.sizes[0] == PARAMETERS.smallest_size
    wide = SensorParameters(smallest_size=1e-3)
    placement = placed(valley, (0, 0, 0), (0, 1, 0), wide)
    assert placement.sizes[0] == pytest.approx(2 * TOLERANCE / 0.8, rel=1e-6)


def test_a_bowl_admits_the_square_whose_corners_reach_the_tolerance():
    radius = 0.6
    bowl = sheet(lambda x, z: radius - np.sqrt(radius**2 - x**2 - z**2), half=0.4, cells=400)
    reach = np.sqrt(radius**2 - (radius - TOLERANCE) ** 2)
    placement = placed(bowl, (0, 0, 0), (0, 1, 0))
    assert placement.sizes[0] == pytest.approx(np.sqrt(2) * reach, rel=2e-3)


THIN = surface_of(
    [[0.07, 0, -0.5], [0.07, 0, 0.5], [0.07, 0.5, 0.5], [0.07, 0.5, -0.5]], [[0, 1, 2], [0, 2, 3]]
)
LOW = box((-0.3, -0.05, -0.5), (-0.11, 0.003, 0.5))


@pytest.mark.parametrize(("wall", "size"), [(THIN, 0.14), (LOW, 0.22)], ids=["thin", "low"])
def test_a_wall_bounds_the_square_however_thin_or_low(wall, size):
    placement = placed(joined(PLATE, wall), (0, 0, 0), (0, 1, 0))
    assert placement.sizes[0] == pytest.approx(size, rel=1e-6)
    assert not placement.blocked[0]


@pytest.mark.parametrize(
    "direction", [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
)
def test_a_narrow_wall_on_any_side_and_at_any_corner_bounds_the_square(direction):
    middle = 0.07 * np.array(direction)
    across = 5e-4 * np.array([-direction[1], direction[0]])
    (left, front), (right, back) = middle - across, middle + across
    wall = surface_of(
        [[left, 0, front], [right, 0, back], [right, 0.5, back], [left, 0.5, front]],
        [[0, 1, 2], [0, 2, 3]],
    )
    placement = placed(joined(PLATE, wall), (0, 0, 0), (0, 1, 0))
    assert placement.sizes[0] == pytest.approx(0.14, rel=1e-6)


def test_an_overhang_beside_the_way_in_bounds_the_square():
    shelf = joined(PLATE, box((0.06, 0.3, -0.5), (0.5, 0.32, 0.5)))
    placement = placed(shelf, (0, 0, 0), (0, 1, 0))
    assert 0.12 * 31 / 32 <= placement.sizes[0] <= 0.12 * 32 / 31 + 1e-9
    assert (placement.heights <= TOLERANCE).all()
    assert not placement.blocked[0]


def test_a_shelf_over_the_probed_point_blocks_and_the_surface_below_is_still_felt():
    shelf = joined(
        sheet(lambda x, z: -0.5 * x**2, half=0.5, cells=50),
        box((-0.5, 0.3, -0.5), (0.5, 0.32, 0.5)),
    )
    placement = placed(shelf, (0, 0, 0), (0, 1, 0))
    assert placement.blocked[0]
    assert placement.sizes[0] == PARAMETERS.largest_size
    assert -0.02 < placement.heights.min() < placement.heights.max() <= 0


def test_the_mode_says_whether_the_square_adapts():
    bowl = hard_probes()["bowl, inside"]
    placement = placed(bowl.surface, bowl.point, bowl.normal, mode="never")
    assert placement.sizes[0] == PARAMETERS.largest_size
    assert placement.heights.max() > TOLERANCE
    assert placement.record.runs == 0
    dome = sheet(lambda x, z: -(x**2) - z**2, half=0.4, cells=60)
    auto, always = (placed(dome, (0, 0, 0), (0, 1, 0), mode=mode) for mode in ("auto", "always"))
    assert (auto.record.needed, auto.record.runs) == (0, 0)
    assert (always.record.needed, always.record.runs) == (0, 1)
    np.testing.assert_array_equal(always.heights, auto.heights)


@pytest.mark.slow
@settings(max_examples=25)
@given(surfaces(kinds=("sheet", "boxes")), st.integers(0, 1000))
def test_whatever_the_ground_the_square_is_admissible_and_the_largest(surface, seed):
    points, normals, _ = probes_on(surface, 12, seed)
    caster, poses = RayCaster(surface), make_poses(points, normals)
    placement = place_batch(caster, poses, PARAMETERS, "auto")
    sizes, penetration = placement.sizes, placement.heights.max(axis=(1, 2))
    smallest, largest = PARAMETERS.smallest_size, PARAMETERS.largest_size

    assert ((sizes >= smallest) & (sizes <= largest)).all()
    assert not np.isnan(placement.heights).any()
    assert (penetration[(sizes > smallest) & ~placement.blocked] <= TOLERANCE).all()

    # A square larger by two sensing points is penetrated at its rim; a fine cast finds it there.
    shrunk = np.flatnonzero((sizes > smallest) & (sizes < largest / 1.07) & ~placement.blocked)
    lifts = np.full(len(shrunk), caster.reach)
    grown = cast_heights(caster, poses[shrunk], 1.07 * sizes[shrunk], lifts, grid_layout(192, 192))
    assert (grown.max(axis=(1, 2)) > TOLERANCE).all()


@pytest.mark.parametrize("resolution", [2, 3, 32, 256])
def test_sensing_points_on_the_edges_do_not_shrink_a_square_without_end(monkeypatch, resolution):
    """A mistake in the places of the sensing points leaves a square nearly as large as before, pass after pass."""
    valley = sheet(lambda x, z: 0.8 * np.abs(x) + 0 * z, half=0.4, cells=80)
    parameters = SensorParameters(resolution=resolution, smallest_size=1e-3)
    assert placed(valley, (0, 0, 0), (0, 1, 0), parameters).sizes[0] >= 1e-3
    monkeypatch.setattr(
        placing, "unobstructed_half_sizes", lambda heights, sizes, *_: sizes / 2 * (1 - 1e-9)
    )
    with pytest.raises(EndlessLoopError, match="the shrinking of pads took more than"):
        placed(valley, (0, 0, 0), (0, 1, 0), parameters)
