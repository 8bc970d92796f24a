"""Heights against those of the mesh in closed form."""

import numpy as np
import pytest
from sensor.shapes import box, joined, sheet, surface_of

from visuohaptic.geometry.layouts import grid_layout, sensing_offsets
from visuohaptic.geometry.raycasting import MISS, RayCaster
from visuohaptic.sensor.imprints import cast_heights, make_poses, smooth_normals

HALF, CELLS, SIZE = 0.25, 50, 0.3


SHAPES = {
    "sphere": lambda x, z: np.sqrt(1 - x**2 - z**2) - 1,
    "saddle": lambda x, z: 0.8 * (x**2 - z**2),
    "groove": lambda x, z: 3 * np.abs(np.abs(x) - 0.1) - 0.3 + 0 * z,
}
GRID, FOUR = grid_layout(32, 32), grid_layout(4, 4)


def mesh_height(height, x, z, half=HALF, cells=CELLS):
    """The sheet's own height in float64: linear over the triangle that (x, z) lies in."""
    pitch = 2 * half / cells
    column, row = (x + half) / pitch, (z + half) / pitch
    i, k = np.floor(column).astype(int), np.floor(row).astype(int)
    u, v = column - i, row - k

    def corner(di, dk):
        along = np.linspace(-half, half, cells + 1)
        return height(along[i + di], along[k + dk])

    low, high = corner(0, 0), corner(1, 1)
    beside = np.where(u >= v, corner(1, 0), corner(0, 1))
    steep, flat = np.maximum(u, v), np.minimum(u, v)
    return low + (beside - low) * steep + (high - beside) * flat


def random_rotation(generator):
    matrix, _ = np.linalg.qr(generator.normal(size=(3, 3)))
    return matrix * np.sign(np.linalg.det(matrix))


def sensing_grid(size, resolution):
    x, z = np.meshgrid(*(2 * [0.5 * size * sensing_offsets(resolution)]))
    return x, z


def heights_over(surface, aside=0.0):
    poses = make_poses(np.array([[aside, 0.0, 0.0]]), np.array([[0, 1.0, 0]]))
    np.testing.assert_allclose(poses.columns[0], (1, 0, 0), atol=1e-12)
    return cast_heights(RayCaster(surface), poses, np.array([SIZE]), np.array([2.0]), GRID)[0]


@pytest.mark.parametrize("name", SHAPES)
def test_neither_the_caster_nor_pose_and_place_add_an_error(name):
    generator = np.random.default_rng(7)
    surface = sheet(SHAPES[name], HALF, CELLS)
    turn = random_rotation(generator)
    shift = generator.uniform(-0.4, 0.4, 3)
    moved = surface_of(surface.vertices @ turn.T + shift, surface.faces)
    poses = make_poses(shift[None], turn[:, 1][None])
    heights = cast_heights(RayCaster(moved), poses, np.array([0.2]), np.array([2.5]), GRID)[0]
    x, z = sensing_grid(0.2, 32)
    offsets = x[..., None] * poses.columns[0] + z[..., None] * poses.rows[0]
    own = offsets @ turn
    expected = mesh_height(SHAPES[name], own[..., 0], own[..., 2])
    assert np.abs(heights - expected).max() < 1e-12


def test_a_step_is_met_exactly():
    floor, edge = -0.07, 0.031
    steps = joined(
        box((-0.5, -0.5, -0.5), (edge, floor, 0.5)), box((edge, -0.5, -0.5), (0.5, 0, 0.5))
    )
    heights = heights_over(steps, 0.05)
    x = sensing_grid(SIZE, 32)[0] + 0.05
    np.testing.assert_allclose(heights, np.where(x < edge, floor, 0.0), rtol=0, atol=1e-15)


def test_sensing_points_on_edges_and_vertices_of_the_mesh_meet_it():
    # Cells of the mesh as large as the sensor's: every ray runs into a vertex or along an edge.
    surface = sheet(lambda x, z: 0 * x, half=0.15 * 31 / 32, cells=31)
    heights = heights_over(surface)
    np.testing.assert_allclose(heights[1:-1, 1:-1], 0.0, rtol=0, atol=1e-15)


def test_sensing_points_are_the_centres_of_equal_cells():
    np.testing.assert_allclose(sensing_offsets(4), [-0.75, -0.25, 0.25, 0.75])
    for resolution in (2, 3, 32, 33):
        offsets = sensing_offsets(resolution)
        np.testing.assert_array_equal(offsets, -offsets[::-1])


class LeakyCaster(RayCaster):
    """Loses a few rays of its first cast in float32, or lets them fall deeper, as through cracks between faces."""

    def _cast(self, origins, directions):
        hits, doubtful = super()._cast(origins, directions)
        if len(origins) == 32 * 32:
            hits.distance[[100, 333]] = np.inf
            hits.face[[100, 333]] = MISS
            hits.distance[700] += 5 * SIZE / 32
        return hits, doubtful


def test_a_miss_between_hits_is_cast_again():
    surface = sheet(lambda x, z: -(x**2), half=0.4, cells=60)
    poses = make_poses(np.zeros((1, 3)), np.array([[0, 1.0, 0]]))
    pose = (poses, np.array([SIZE]), np.array([2.0]), GRID)
    leaky, tight = LeakyCaster(surface), RayCaster(surface)
    np.testing.assert_array_equal(cast_heights(leaky, *pose), cast_heights(tight, *pose))


class RecordingCaster(RayCaster):
    """Tells which of given distances of a first cast would be cast again."""

    def first_hits(self, origins, directions, suspects=None):
        self.again = suspects(self.distances.ravel()).reshape(self.distances.shape)
        return super().first_hits(origins, directions, suspects)


@pytest.mark.parametrize("edges", [(0.8, 0.4), (0.4, 1.2)])
def test_a_ray_is_cast_again_if_deeper_than_both_neighbours_of_an_axis_by_four_of_the_longer_spacings(
    edges,
):
    """Each case: a distance in row 2, column 2 of 4 x 4, those before and behind in the row, and in the column."""
    drop = 4 * max(edges) / 4
    near, far = 1 + 0.9 * drop, 1 + 1.1 * drop
    cases = [
        (far, (1, 1), (9, 9), True),
        (far, (9, 9), (1, 1), True),
        (far, (1, 9), (9, 1), False),
        (far, (9, 1), (1, 9), False),
        (near, (1, 1), (1, 1), False),
        (near, (0.5, 1), (1, 0.5), False),
        (np.inf, (1, 1), (9, np.inf), True),
        (np.inf, (np.inf, np.inf), (1, np.inf), False),
        (np.inf, (1, np.inf), (np.inf, np.inf), False),
    ]
    caster = RecordingCaster(sheet(lambda x, z: 0 * x, half=0.4, cells=2))
    caster.distances = np.ones((len(cases), 4, 4))
    for distances, (middle, row, column, _) in zip(caster.distances, cases, strict=True):
        distances[2, [1, 3]], distances[[1, 3], 2], distances[2, 2] = row, column, middle
    places = make_poses(np.zeros((len(cases), 3)), np.tile([0, 1.0, 0], (len(cases), 1)))
    cast_heights(caster, places, np.tile(edges, (len(cases), 1)), np.full(len(cases), 2.0), FOUR)
    expected = [is_again for *_, is_again in cases]
    assert caster.again[:, 2, 2].tolist() == expected


@pytest.mark.parametrize("place", [(0, 2), (3, 2), (2, 0), (2, 3), (0, 0), (3, 3)])
def test_a_miss_on_the_border_is_cast_again_only_between_two_hits_along_the_border(place):
    caster = RecordingCaster(sheet(lambda x, z: 0 * x, half=0.4, cells=2))
    caster.distances = np.ones((1, 4, 4))
    caster.distances[0][place] = np.inf
    cast_heights(
        caster, make_poses(np.zeros((1, 3)), np.array([[0, 1.0, 0]])), np.ones(1), np.ones(1), FOUR
    )
    is_corner = set(place) <= {0, 3}
    assert caster.again.sum() == (not is_corner)
    assert caster.again[0][place] == (not is_corner)


def test_a_true_gap_between_hits_stays_a_gap():
    slats = joined(box((-0.3, -0.1, -0.3), (0.001, 0, 0.3)), box((0.01, -0.1, -0.3), (0.3, 0, 0.3)))
    heights = heights_over(slats, -0.1)
    x, _ = sensing_grid(SIZE, 32)
    between = (x - 0.1 > 0.001) & (x - 0.1 < 0.01)
    assert between.any()
    np.testing.assert_array_equal(np.isneginf(heights), between)


def test_smoothed_normals_average_a_ridged_surface():
    ridged = sheet(lambda x, z: 0.02 * np.abs((x * 25) % 2 - 1) + 0.2 * x, HALF, 200)
    slope = np.array([[-0.2, 1.0, 0.0]]) / np.hypot(0.2, 1)
    point = np.array([[0.01, float(0.02 * 0.75 + 0.002), 0.0]])
    poses = make_poses(point, np.array([[-0.7, 1.0, 0]]) / np.hypot(0.7, 1))
    normals = smooth_normals(RayCaster(ridged), poses, 0.3, 0.3)
    assert normals[0] @ slope[0] > np.cos(np.radians(8))
    assert poses.normals[0] @ slope[0] < np.cos(np.radians(20))
