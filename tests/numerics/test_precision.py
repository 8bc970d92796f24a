"""What kernels give, against closed forms: how near it comes, and that it comes nearer as it should."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from numerics import drawings
from numerics.shapes import float32_exact, of_trimesh, surface_of
from numerics.tolerances import U32

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import EffectModes, Scene
from visuohaptic.sensor.frames import column_axes, row_axes
from visuohaptic.sensor.gallery import sheet
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.touching import touch

SEEDS = st.integers(0, 2**32 - 1)
ABSOLUTE = SensorParameters(normalisation="absolute", normal="given", largest_size=0.2)
RIGID = Scene()


def wall(slope_right, slope_up, bump):
    """Give z = height(x, y) as a wall that faces +z: tilted planes, or a bump that is not centred."""

    def height(x, down):
        return slope_right * x - slope_up * down + bump * (x - 0.02) * (x + 0.01 * down)

    flat = sheet(height, half=0.5, cells=128)
    x, y, z = flat.vertices.T
    # Turn the sheet's up to +z: x stays, what ran along z runs down.
    return float32_exact(surface_of(np.column_stack([x, -z, y]), flat.faces)), height


@given(right=st.floats(-0.4, 0.4), up=st.floats(-0.4, 0.4))
def test_an_imprint_of_a_tilted_wall_is_the_plane_in_closed_form(hold, right, up):
    surface, height = wall(right, up, 0.0)
    felt = touch(
        RayCaster(surface), np.array([[0.0, 0, 0]]), np.array([[0.0, 0, 1]]), ABSOLUTE, RIGID
    )
    steps = (np.arange(32) + 0.5) / 32 - 0.5
    across, down = np.meshgrid(felt.size[0] * steps, felt.size[0] * steps)
    expected = height(across, down)
    gaps = np.clip(expected, 0, 0.1).max() - expected
    wanted = 1 - np.clip(gaps / ABSOLUTE.depth_range, 0, 1)
    hold(
        "precision/imprint of a plane in closed form",
        np.abs(felt.images[0] - wanted).ravel(),
        f"a wall of slopes {right:.2f} to the right and {up:.2f} upwards",
        drawings.image(wanted, "a tilted wall"),
    )


@given(seed=SEEDS)
def test_the_frame_on_a_surface_is_right_handed_and_square(hold, seed):
    normals = np.random.default_rng(seed).normal(size=(200, 3))
    normals[:40] = np.rint(normals[:40])
    normals = normals[np.linalg.norm(normals, axis=1) > 0]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for orientation in ("upright", "transported"):
        columns = column_axes(normals, orientation)
        # Rows run downwards seen from outside, so columns × rows point into the object.
        frame = np.stack([columns, -row_axes(normals, columns), normals], axis=1)
        hold(
            "precision/frames on the surface",
            [
                np.abs(np.einsum("nij,nkj->nik", frame, frame) - np.eye(3)).max(),
                np.abs(np.linalg.det(frame) - 1).max(),
            ],
            f"{orientation}, normals of seed {seed}",
            cases=2 * len(normals),
        )


@pytest.mark.parametrize(
    "level",
    [2, 3, 4, pytest.param(5, marks=pytest.mark.hard), pytest.param(6, marks=pytest.mark.hard)],
)
def test_a_tessellated_sphere_comes_near_the_true_one_by_the_square_of_its_edge(hold, level):
    ball = float32_exact(of_trimesh(trimesh.creation.icosphere(level)))
    generator = np.random.default_rng(level)
    directions = generator.normal(size=(20_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    hits = RayCaster(ball).settled_hits(2 * directions, -directions)
    edge = np.linalg.norm(ball.triangles - np.roll(ball.triangles, 1, axis=1), axis=2).max()
    # The middle of an even triangle of edge e with its corners on the unit sphere.
    deepest = 1 - np.sqrt(1 - edge**2 / 3)
    hold(
        "precision/tessellated sphere",
        (np.abs(hits.distance - 1) - 4 * U32) / deepest,
        f"{len(ball.faces)} faces",
        drawings.triangles(
            ball.triangles[ball.triangles[:, :, 2].mean(axis=1) > 0], "half a ball", most=200
        ),
    )


@pytest.mark.parametrize("resolution", [8, 32, 64])
def test_a_sphere_pressed_on_its_top_is_felt_as_a_sphere(hold, resolution):
    ball = float32_exact(of_trimesh(trimesh.creation.icosphere(6)))
    corner = ball.vertices[np.argmax(ball.vertices[:, 1])]
    normal = corner / np.linalg.norm(corner)
    parameters = ABSOLUTE.model_copy(update={"resolution": resolution})
    felt = touch(
        RayCaster(ball), corner[None], normal[None], parameters, Scene(effects=EffectModes())
    )
    steps = ((np.arange(resolution) + 0.5) / resolution - 0.5) * felt.size[0]
    radius = np.hypot(*np.meshgrid(steps, steps))
    depth = 1 - np.sqrt(1 - radius**2)
    hold(
        "precision/sphere under the sensor",
        np.abs(felt.gaps[0] - depth).ravel(),
        f"{resolution} × {resolution} sensing points, 81,920 faces",
        drawings.image(felt.images[0], "a ball's imprint"),
    )


@given(radius=st.floats(0.03, 0.09))
def test_what_is_out_of_reach_is_zero_and_what_is_within_is_not_negative(hold, radius):
    ball = float32_exact(of_trimesh(trimesh.creation.icosphere(4, radius=radius)))
    top = np.array([[0.0, ball.vertices[:, 1].max(), 0.0]])
    deep = ABSOLUTE.model_copy(update={"depth_range": 0.5 * radius})
    felt = touch(RayCaster(ball), top, np.array([[0.0, 1, 0]]), deep, RIGID)
    steps = ((np.arange(32) + 0.5) / 32 - 0.5) * felt.size[0]
    aside = np.hypot(*np.meshgrid(steps, steps))
    image = felt.images[0]
    beyond = aside > np.sqrt(0.75) * radius * 1.02
    hold(
        "precision/values out of reach and beyond full scale",
        np.where(beyond, image != 0, ~((image >= 0) & (image <= 1))).ravel(),
        f"a ball of radius {radius:.3f} under a square of {felt.size[0]:.2f}",
        drawings.image(np.nan_to_num(image, posinf=1, neginf=0), "a small ball's imprint"),
    )
